"""Searches on grids: A*, distance fields, replanning with D* Lite."""
