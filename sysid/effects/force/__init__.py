"""Forces in parallel to the valve."""
