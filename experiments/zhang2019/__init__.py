"""Zhang et al. 2019: A* with a turning cost in its evaluation function."""
