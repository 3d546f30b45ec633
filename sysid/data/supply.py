"""Settings of the current supply: which measured currents were meant to be one."""

from typing import Final

SAME_CURRENT: Final = 0.02
"""Currents that differ by less, in parts of the largest, are one setting of the supply."""
OFF: Final = 1e-3
"""A; so much a supply that is off may let through, or a meter beside it show."""


def same_current(largest: float) -> float:
    """A; currents that differ by no more are one setting of the supply.

    Args:
        largest: A, of the campaign.
    """
    return max(SAME_CURRENT * largest, OFF)
