"""Swarms that minimise a function of real numbers: wolves, ants, genes and particles."""
