"""What was done to a damper before a test, for effects that remember it."""

import dataclasses
from itertools import pairwise

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops
from sysid.motion.motion import Motion


def with_history(
    motion: Motion,
    *,
    run_order: Float[np.ndarray, " loop"] | None = None,
    cycle: Float[np.ndarray, " loop"] | None = None,
) -> Motion:
    """The same loops with their place in the campaign.

    The way the current came is found from the order: the sign of its last change.

    Args:
        motion: L loops, current [L, 1].
        run_order: [L] position of each test in the campaign, any increasing numbers.
        cycle: [L] number of the cycle in its test, from 0.

    Returns:
        With `run_share`, `ramp` and `cycle` as far as they follow.
    """
    changes = {}
    if run_order is not None:
        first, last = run_order.min(), run_order.max()
        share = (run_order - first) / max(last - first, 1.0)
        changes["run_share"] = jnp.asarray(share[:, None])
        changes["ramp"] = jnp.asarray(_ramp(run_order, np.asarray(motion.current)[:, 0])[:, None])
    if cycle is not None:
        changes["cycle"] = jnp.asarray(cycle[:, None])
    return dataclasses.replace(motion, **changes)


def into_cycle(loops: Loops, points: int) -> Float[np.ndarray, "loop point"]:
    """Time of each phase point since the middle of its cycle, in cycles; [L, 1] zeros if unknown.

    Added to the number of a cycle it is what `Motion.cycle` is at every point.

    Args:
        loops: L tests.
        points: Of the phase grid.
    """
    if loops.start_phase is None:
        return np.zeros((len(loops.ids), 1))
    turns = np.arange(points)[None, :] / points - loops.start_phase[:, None] / (2.0 * np.pi)
    return np.mod(np.round(turns, 9), 1.0) - 0.5


def _ramp(order: np.ndarray, current: np.ndarray) -> np.ndarray:
    """Sign of the last change of current before each test, 0 before the first change."""
    ramp, last = np.zeros(order.size), 0.0
    places = np.argsort(order, kind="stable")
    for before, here in pairwise(places):
        change = current[here] - current[before]
        last = float(np.sign(change)) if abs(change) > 1e-9 else last
        ramp[here] = last
    return ramp
