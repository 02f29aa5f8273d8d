"""Fleets: vessels on routes of their own that meet each other by stated rules."""
