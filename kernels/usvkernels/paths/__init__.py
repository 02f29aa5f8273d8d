"""Kernels that shorten, smooth, track and measure paths."""
