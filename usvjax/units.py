"""Units of charts and logbooks in SI."""

KNOT = 1852.0 / 3600.0  # m/s
NAUTICAL_MILE = 1852.0  # m
