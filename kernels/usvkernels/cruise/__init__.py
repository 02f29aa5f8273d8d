"""The multi-target cruise: cells that flip, the vessel's legs, its track pulled straight."""
