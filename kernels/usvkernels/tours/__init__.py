"""The order of visits: tours over a matrix of distances, many at once, runs on the last axis."""
