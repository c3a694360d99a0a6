"""Loops of diffusion, compiled by numba."""
