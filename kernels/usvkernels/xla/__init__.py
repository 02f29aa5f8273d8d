"""Working with what XLA's CPU backend does."""
