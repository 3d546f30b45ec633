"""Compiled programs of earlier diagnoses, dropped before they fill a process's memory maps."""

from pathlib import Path
from typing import Final

import jax

MAPS: Final = Path("/proc/self/maps")
MOST: Final = 25_000
"""Memory maps from which compiled programs are dropped: each program takes some of the 65 530 that
Linux allows a process, a diagnosis makes a few hundred programs, and beyond the limit it dies."""


def make_room() -> bool:
    """Drop all compiled programs if there are many; they are compiled again, or read from disk.

    Returns:
        Whether they were dropped; never where the system does not tell of its maps.
    """
    if not MAPS.exists():
        return False
    with MAPS.open() as lines:
        many = sum(1 for _ in lines) > MOST
    if many:
        jax.clear_caches()
    return many
