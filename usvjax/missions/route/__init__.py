"""Routes on grids: searches, and what is done to their paths."""
