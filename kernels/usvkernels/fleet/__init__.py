"""Fleets: vessels that sail among each other, N in one episode, thousands of episodes at once."""
