"""Chen et al. 2023: A* smoothed to a vessel's turning circle, against A* and its B-spline."""
