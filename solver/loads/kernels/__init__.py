"""The compiled loops over particles. Kept apart from the load models, which are read without numba."""
