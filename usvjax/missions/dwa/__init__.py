"""Closed-loop navigation under the dynamic window approach (Tan et al. 2022)."""
