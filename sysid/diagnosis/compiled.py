"""Compiled programs of earlier diagnoses, dropped before they fill a process's memory maps."""

from pathlib import Path
from typing import Final

import jax

MAPS: Final = Path("/proc/self/maps")
MOST: Final = 45_000
"""Memory maps from which compiled programs are dropped: each program takes some of the 65 530 that
Linux allows a process, and beyond that limit it dies.  A diagnosis makes a few hundred programs, of
which the next one of as many tests needs most again."""


def make_room(most: int = MOST) -> bool:
    """Drop all compiled programs if there are many; they are compiled again, or read from disk.

    Args:
        most: Maps that are not many.

    Returns:
        Whether they were dropped; never where the system does not tell of its maps.
    """
    if not MAPS.exists():
        return False
    with MAPS.open() as lines:
        many = sum(1 for _ in lines) > most
    if many:
        jax.clear_caches()
    return many
