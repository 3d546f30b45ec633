"""Effects between recorded motion and motion at the valve."""
