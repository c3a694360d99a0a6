"""Loops of models whose particles feel each other, compiled by numba."""
