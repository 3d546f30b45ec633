"""Effects on how the valve's parts depend on frequency, temperature, speed or force."""
