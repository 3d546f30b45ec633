"""Walks in chunks of fixed sizes: who has arrived makes room for who waits.

The steps that starts need differ by ten; a batch that waits for its slowest computes mostly for
those that have arrived.  Here a chunk has a fixed number of slots, looked at every few steps, and
compiled programs are needed for two sizes only.
"""

from dataclasses import dataclass
from typing import Final

import jax
import numpy as np
from jaxtyping import Bool, Float, Int

from sysid.fleet.batched_descent import Walk, advance, begin
from sysid.fleet.stack import Stack
from sysid.models.generalized_coordinates import Variant

SLOTS: Final = (64, 16)
"""Sizes of chunks; the smaller one is for the last walks under way."""
STRIDE: Final = 4
"""Steps between two looks."""


@dataclass(frozen=True)
class Ends:
    """Where walks ended, T of them.

    Attributes:
        u: [T, n].
        cost: [T] over Σ w² F².
        steps: [T].
        converged: [T].
        slope: [T, n] diagonal of JᵀJ, relative to Σ w² F²: nothing where the cost does not
            depend on a coordinate.
        gradient: [T, n] Jᵀr, likewise.
    """

    u: Float[np.ndarray, "walk n"]
    cost: Float[np.ndarray, " walk"]
    steps: Int[np.ndarray, " walk"]
    converged: Bool[np.ndarray, " walk"]
    slope: Float[np.ndarray, "walk n"]
    gradient: Float[np.ndarray, "walk n"]


def walk_all(
    variant: Variant,
    stack: Stack,
    owner: Int[np.ndarray, " walk"],
    starts: Float[np.ndarray, "walk n"],
    *,
    tolerance: float,
    max_steps: int,
    damping: float,
) -> Ends:
    """Levenberg–Marquardt from each of T starts.

    Args:
        variant: Of the model.
        stack: The fleet.
        owner: [T] damper of each start.
        starts: [T, n].
        tolerance: Relative decrease of the cost, twice in a row, at which a walk has arrived.
        max_steps: Of a walk; a few more may be taken.
        damping: λ of the first step, dimensionless.
    """
    count = len(starts)
    ends = Ends(
        np.array(starts), np.full(count, np.inf), np.zeros(count, dtype=int),
        np.zeros(count, dtype=bool), np.zeros_like(starts), np.zeros_like(starts),
    )  # fmt: skip
    begun = 0
    task = np.empty(0, dtype=int)  # of each slot
    walk: Walk | None = None
    while begun < count or task.size:
        size = SLOTS[0] if task.size + count - begun > SLOTS[1] else SLOTS[1]
        fresh = np.arange(begun, min(count, begun + size - task.size))
        begun += fresh.size
        task = np.concatenate([task, fresh])
        full = _refilled(walk, begin(starts[fresh], damping), size)
        rows = stack.rows(owner[np.concatenate([task, np.repeat(task[:1], size - task.size)])])
        full = advance(variant, rows, full, np.asarray(tolerance), STRIDE)
        arrived, at = np.asarray(full.converged), jax.tree.map(np.asarray, full)
        done = (arrived | (at.steps >= max_steps))[: task.size]
        here, ended = np.flatnonzero(done), task[done]
        ends.u[ended], ends.cost[ended] = at.u[here], at.normal.cost[here]
        ends.steps[ended], ends.converged[ended] = at.steps[here], arrived[here]
        ends.slope[ended] = np.diagonal(at.normal.matrix[here], axis1=1, axis2=2)
        ends.gradient[ended] = at.normal.gradient[here]
        going = np.flatnonzero(~done)
        walk, task = jax.tree.map(lambda z, k=going: z[k], at), task[going]
    return ends


def _refilled(walk: Walk | None, fresh: Walk, size: int) -> Walk:
    """Those under way, then the fresh ones, then copies that nobody looks at."""
    parts = [fresh] if walk is None else [walk, fresh]

    def joined(*z: np.ndarray) -> np.ndarray:
        rows = np.concatenate(z)
        return np.concatenate([rows, np.repeat(rows[:1], size - len(rows), axis=0)])

    return jax.tree.map(joined, *parts)
