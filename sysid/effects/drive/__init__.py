"""Effects between commanded and effective current."""
