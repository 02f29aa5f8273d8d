"""Planners of paths between two cells by ants, genes and particles."""
