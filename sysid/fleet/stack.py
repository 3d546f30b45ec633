"""The loops of many dampers in arrays of one shape: what a batched fit works on."""

from collections.abc import Sequence
from typing import Any, Final

import equinox as eqx
import jax
import numpy as np
from jaxtyping import Array, Float, Int

from sysid.data.loops import Loops
from sysid.errors import FitError
from sysid.identification.problem import Weights, loop_problem, test_weights
from sysid.models.coordinates import Reference, reference_current
from sysid.motion.motion import fundamental_sign

ROUND: Final = 4
"""Numbers of tests are filled up to a multiple, so that fleets share compiled programs."""


class Stack(eqx.Module):
    """D dampers, L tests of each on grids of J points; tests that are missing have no weight.

    Arrays of NumPy outside of compiled programs.

    Attributes:
        velocity: [D, L, J] m/s.
        force: [D, L, J] w F / √Σ w² F², dimensionless: the squares of a damper sum to 1.
        weight: [D, L] w / √Σ w² F², 1/N; 0 where a test is missing.
        sign: [J] sgn ẍ of loops on this grid.
        peak_velocity: [D, L] m/s.
        current: [D, L] A.
        reference: Magnitudes of every damper, [D] each.
        scale: [D] Σ w² F², N² for weights "paper".
    """

    velocity: Float[Array | np.ndarray, "damper test point"]
    force: Float[Array | np.ndarray, "damper test point"]
    weight: Float[Array | np.ndarray, "damper test"]
    sign: Float[Array | np.ndarray, " point"]
    peak_velocity: Float[Array | np.ndarray, "damper test"]
    current: Float[Array | np.ndarray, "damper test"]
    reference: Reference
    scale: Float[Array | np.ndarray, " damper"]

    @property
    def dampers(self) -> int:
        """D."""
        return self.force.shape[0]

    def rows(self, index: Int[np.ndarray, " damper"]) -> "Stack":
        """Some of the dampers, in any order and as often as wanted.

        Args:
            index: Of dampers.
        """

        def taken(z: Array | np.ndarray) -> np.ndarray:
            return np.asarray(z)[index]

        return Stack(
            taken(self.velocity), taken(self.force), taken(self.weight), self.sign,
            taken(self.peak_velocity), taken(self.current),
            jax.tree.map(taken, self.reference), taken(self.scale),
        )  # fmt: skip

    @property
    def points(self) -> int:
        """Points of a loop, J."""
        return self.force.shape[-1]


def stack_loops(fleet: Sequence[Loops], weights: Weights = "paper") -> Stack:
    """Put the loops of many dampers side by side.

    Args:
        fleet: Loops of each damper, all on one phase grid.  Numbers and conditions of tests may
            differ.
        weights: As for `loop_problem`.

    Raises:
        FitError: Phase grids differ, a damper has no test, or one that cannot be fitted.
    """
    grids = {loops.force.shape[1] for loops in fleet if loops.ids}
    empty = [k for k, loops in enumerate(fleet) if not loops.ids]
    if empty or not grids:
        raise FitError(
            "no test is left to fit", where=f"damper {empty[0]}" if empty else "fleet",
            advice="Leave the dampers without tests out of the fleet",
        )  # fmt: skip
    if len(grids) > 1:
        raise FitError(
            f"loops have {' and '.join(map(str, sorted(grids)))} points",
            where="fleet",
            advice="Cut the loops of all dampers on one phase grid",
        )
    most = -(-max(len(loops.ids) for loops in fleet) // ROUND) * ROUND
    rows = [_row(loops, weights, most) for loops in fleet]
    columns = {
        name: jax.tree.map(lambda *z: np.stack(z), *(row[name] for row in rows)) for name in rows[0]
    }
    columns["reference"] = Reference(**columns["reference"])
    return Stack(**columns, sign=-fundamental_sign(grids.pop()))


def thinned(stack: Stack, points: int) -> Stack:
    """The same on fewer points of each loop, the costs of the same size.

    Args:
        stack: On J points.
        points: At least so many are kept, evenly.
    """
    # a divisor of J keeps the grid periodic and even
    step = max(d for d in range(1, max(1, stack.points // points) + 1) if stack.points % d == 0)
    if step == 1:
        return stack
    root = float(np.sqrt(step))
    return Stack(
        stack.velocity[..., ::step], root * stack.force[..., ::step], root * stack.weight,
        stack.sign[::step], stack.peak_velocity, stack.current, stack.reference, stack.scale,
    )  # fmt: skip


def _row(loops: Loops, weights: Weights, tests: int) -> dict[str, Any]:
    """One damper as arrays of `tests` rows, the last ones filled up with the first test."""
    if not np.isfinite(loops.current).all():
        loop_problem(loops, weights)  # which says where a current is missing
    missing = tests - len(loops.ids)
    index = np.concatenate([np.arange(len(loops.ids)), np.zeros(missing, dtype=int)])
    weight = np.asarray(test_weights(loops, weights))
    force = loops.force * weight[:, None]
    scale = float(np.sum(force**2))
    weight, force = weight[index] / np.sqrt(scale), force[index] / np.sqrt(scale)
    weight[len(loops.ids) :], force[len(loops.ids) :] = 0.0, 0.0
    return {
        "velocity": loops.velocity[index],
        "force": force,
        "weight": weight,
        "peak_velocity": loops.peak_velocity[index],
        "current": loops.current[index],
        "reference": {
            "force": float(np.sqrt(np.mean(loops.force**2))),
            "speed": float(loops.peak_velocity.max()),
            "current": reference_current(loops.current),
            "length": float(np.abs(loops.displacement).max()),
        },
        "scale": scale,
    }
