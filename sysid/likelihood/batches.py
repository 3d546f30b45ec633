"""What simulates the tests of a campaign: one compiled program, whatever their number."""

from collections.abc import Callable
from typing import Any, Final

import jax
import numpy as np

BATCH: Final = 32
"""Tests that are simulated at a time.  A campaign is filled up to a multiple of them."""


def by_batches(program: Callable[..., Any], *rows: Any, axis: int = 0) -> Any:
    """What a compiled program makes of tests, `BATCH` of them after the other.

    Compiling takes a hundred times as long as a run, and models with all their effects are many:
    what was compiled for one campaign serves the next one, of another number of tests.  Signals of
    so few tests stay in the processor's cache, and no more memory is taken than for them.

    Args:
        program: Rows of `BATCH` tests → arrays with as many, each of its own test.
        rows: Arrays, or motions, of a multiple of `BATCH` tests.
        axis: Of the tests in what the program makes.

    Returns:
        The same as the program would make of all tests at once, as NumPy arrays.
    """
    rows = jax.tree.map(np.asarray, rows)
    count = len(jax.tree.leaves(rows)[0])
    made = [
        jax.tree.map(np.asarray, program(*jax.tree.map(lambda z, k=k: z[k : k + BATCH], rows)))
        for k in range(0, count, BATCH)
    ]
    return jax.tree.map(lambda *z: np.concatenate(z, axis=axis), *made)
