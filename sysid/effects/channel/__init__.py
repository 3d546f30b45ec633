"""Effects between true and recorded force."""
