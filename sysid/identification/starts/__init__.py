"""Where to start from, so that no user is ever asked: one model a file."""
