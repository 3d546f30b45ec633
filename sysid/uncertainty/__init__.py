"""How sure the data make us of what was identified."""
