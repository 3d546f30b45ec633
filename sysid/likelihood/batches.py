"""What simulates the tests of a campaign: one compiled program, whatever their number."""

from collections.abc import Callable, Sequence
from typing import Any, Final, TypeVar

import jax
import jax.numpy as jnp
import numpy as np

T = TypeVar("T")

BATCH: Final = 32
"""Tests that are simulated at a time.  A campaign is filled up to a multiple of them."""


def in_batches(rows: T) -> tuple[T, ...]:
    """Rows of tests cut into batches, where they are computed on: once for all that is simulated.

    Args:
        rows: Arrays, or motions, of a multiple of `BATCH` tests.
    """
    count = len(jax.tree.leaves(rows)[0])
    return tuple(
        jax.tree.map(lambda z, k=k: jnp.asarray(np.asarray(z)[k : k + BATCH]), rows)
        for k in range(0, count, BATCH)
    )


def by_batches(program: Callable[..., Any], *batches: Sequence[Any]) -> Any:
    """What a compiled program makes of the tests of a campaign, `BATCH` of them at a time.

    Compiling takes a hundred times as long as a run, and models with all their effects are many:
    what was compiled for one campaign serves the next one, of another number of tests.  Signals of
    so few tests stay in the processor's cache.

    Args:
        program: Rows of `BATCH` tests → arrays with as many, each of its own test.
        batches: Of each of its arguments, `in_batches`.

    Returns:
        The same as the program would make of all tests at once, as NumPy arrays.
    """
    made = [program(*some) for some in zip(*batches, strict=True)]  # begun before any is waited for
    return jax.tree.map(lambda *z: np.concatenate([np.asarray(one) for one in z]), *made)
