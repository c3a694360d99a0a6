"""The loops over particles and nodes, compiled by numba and specialised for interpolator and material model.

Each reads like its equation in docs/architecture.md, "The step". Sums over the nodes i of a particle p use the
weights S_ip and gradients G_ip of the interpolator.
"""
