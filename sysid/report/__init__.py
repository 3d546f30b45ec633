"""Figures and result files: one plot a function `(data, *, ax=None) -> Axes`."""
