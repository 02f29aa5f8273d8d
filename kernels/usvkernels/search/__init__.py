"""Kernels of the grid searches."""
