"""Blind trials: hide an effect, diagnose, open the truth, score."""
