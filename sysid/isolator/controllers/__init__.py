"""Controllers of a damper's current, one a file."""
