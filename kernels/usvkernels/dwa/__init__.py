"""The dynamic window approach: window, candidates, clearance and closed-loop episodes."""
