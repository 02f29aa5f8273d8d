"""Tan et al. 2022: the dynamic window approach with an obstacle search angle."""
