"""The last descents of every damper, on all data, and two ways in which they can be led astray.

Starts are tried on some points of each loop.  Where a parameter is as good as zero there, its
coordinate has run off to where nothing depends on it; on all data it may matter, and would not
come back.  And where a law in current (C_i, or the width) is a straight line there, σ(b + c) − σ(c)
with b → 0, the line is the end of the laws that bend upwards (c < 0): those that bend downwards
begin on its other side, which no descent crosses.
"""

from dataclasses import fields
from typing import Final

import numpy as np
from jaxtyping import Bool, Float, Int

from sysid.fleet.evidence import candidates
from sysid.fleet.slots import Ends, walk_all
from sysid.fleet.stack import Stack
from sysid.identification.multistart import RAN_OFF
from sysid.models.generalized_coordinates import Variant

FINE, FINE_STEPS, FINE_DAMPING = 1e-8, 200, 1e-8
"""Relative decrease of the cost at which a descent has arrived; its steps; λ of the first one."""
NO_SLOPE: Final = 1e-7
"""Diagonal of JᵀJ, relative to the squares of the force, below which nothing depends on a
coordinate."""
BENDS: Final[dict[Variant, tuple[tuple[int, int], ...]]] = {
    "asymmetric": ((3, 4), (9, 10)),
    "symmetric": ((3, 4), (9, 10)),
    "passive": (),
    "mean": ((3, 4),),
}
"""Places of the coordinates of b and c of the laws in current, C_i and the width."""
OTHER_BENDS: Final = ((0.0, 2.0), (5.0, -2.0))
"""Coordinates of (b, c) of laws that bend downwards, and of those that bend both ways."""


def to_the_bottom(
    stack: Stack, variant: Variant, ends: Ends
) -> tuple[Ends, Int[np.ndarray, " damper"]]:
    """The lowest end of last descents on all data, [D], and the steps they took.

    Args:
        stack: The fleet.
        variant: Of the model.
        ends: Of all starts on some points, [D, S].
    """
    count = len(ends.cost)
    owner, start = np.array([(d, k) for d in range(count) for k in candidates(ends.cost[d])]).T
    u, slope = ends.u[owner, start], ends.slope[owner, start]
    last = _finely(stack, variant, owner, np.where(_ran_off(u, slope), _within(u), u))
    steps = np.bincount(owner, last.steps, count).astype(int)
    last = _lowest(last, owner, count)
    owner, u = _second_thoughts(last, variant)
    if owner.size:
        anew = _finely(stack, variant, owner, u)
        steps += np.bincount(owner, anew.steps, count).astype(int)
        last = _lowest(_joined(last, anew), np.concatenate([np.arange(count), owner]), count)
    return last, steps


def _second_thoughts(
    last: Ends, variant: Variant
) -> tuple[Int[np.ndarray, " walk"], Float[np.ndarray, "walk n"]]:
    """Dampers to descend again, and from where."""
    owner: list[int] = []
    starts: list[np.ndarray] = []
    off = _ran_off(last.u, last.slope)
    # beyond, the cost still falls towards the middle: only too slowly for any step to see
    stranded = off & (last.gradient * np.sign(last.u) > 0.0)
    for d in np.flatnonzero(stranded.any(axis=1)):
        owner.append(int(d))
        starts.append(np.where(stranded[d], _within(last.u[d]), last.u[d]))
    for b, c in BENDS[variant]:
        for d in np.flatnonzero(last.u[:, b] < -RAN_OFF):
            for bend in OTHER_BENDS:
                u = last.u[d].copy()
                u[[b, c]] = bend
                owner.append(int(d))
                starts.append(u)
    return np.array(owner, dtype=int), np.array(starts).reshape(len(owner), last.u.shape[1])


def _finely(
    stack: Stack, variant: Variant, owner: np.ndarray, u: Float[np.ndarray, "walk n"]
) -> Ends:
    return walk_all(
        variant, stack, owner, u, tolerance=FINE, max_steps=FINE_STEPS, damping=FINE_DAMPING
    )


def _lowest(ends: Ends, owner: np.ndarray, count: int) -> Ends:
    """Of the walks of every damper the one that ended lowest."""
    order = np.lexsort((ends.cost, owner))
    index = order[np.searchsorted(owner[order], np.arange(count))]
    return Ends(*(getattr(ends, field.name)[index] for field in fields(Ends)))


def _joined(*parts: Ends) -> Ends:
    return Ends(*(
        np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Ends)
    ))  # fmt: skip


def _ran_off(u: np.ndarray, slope: np.ndarray) -> Bool[np.ndarray, "walk n"]:
    """Coordinates that are where nothing depends on them any more."""
    return (np.abs(u) > RAN_OFF) & (slope < NO_SLOPE)


def _within(u: np.ndarray) -> np.ndarray:
    return np.clip(u, -RAN_OFF, RAN_OFF)
