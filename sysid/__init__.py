"""Identify magnetorheological dampers from measured tests."""

__version__ = "0.1.0"
