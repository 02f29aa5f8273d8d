"""Aggregation: fleets gather in a formation on a common heading."""
