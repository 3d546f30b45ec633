"""Many dampers of the generalised model fitted side by side in one compiled program."""
