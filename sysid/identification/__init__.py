"""From loops to an identified damper."""
