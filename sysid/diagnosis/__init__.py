"""What the simulation gets wrong, where, and of what kind."""
