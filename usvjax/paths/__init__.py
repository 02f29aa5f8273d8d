"""What is done with a path: shortened, smoothed, sailed, measured."""
