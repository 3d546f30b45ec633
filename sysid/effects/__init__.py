"""What real damper tests contain and base models do not, one effect a file."""
