"""A valve behind something that gives way: the rod's motion is shared between the two.

The valve moves at u = v − ḋ, where the deflection d follows from the force that both carry.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from sysid.errors import DataError
from sysid.rig.planters.bench_state import BenchState

PerLoop = Float[np.ndarray, " loop"]
Forces = Float[np.ndarray, "... loop"]

_IMPLICIT = 0.55
"""Weight of a step's end: near the trapezoidal rule, which is exact to second order, and damped."""
_NEWTON_STEPS = 12


def valve_behind(
    state: BenchState,
    deflection: Callable[[Forces], Forces],
) -> Float[np.ndarray, "loop phase"]:
    """Velocity of the valve, [L, P] m/s, in the steady state.

    Args:
        state: The tests; its valve must be memoryless.
        deflection: Force, [..., L] N → deflection, [..., L] m, rising with the force.

    Raises:
        DataError: The valve has a memory of its own.
    """
    if not state.valve.memoryless:
        raise DataError("an element in series with this valve cannot be solved point by point")
    points = state.displacement.shape[1]
    side = np.ascontiguousarray(state.side.T)[:, :, None]
    v_m, current = state.peak_velocity, state.valve_current
    rod = np.ascontiguousarray(state.valve_velocity.T)
    dt = state.time_step
    nudge = 1e-6 * v_m[:, 0]

    def force(u: Forces, j: int) -> Forces:
        return state.valve.force(u[..., None], side[j], v_m, current)[..., 0]

    half = points // 2
    u = rod[half]
    d = deflection(force(u, half))
    path = np.empty_like(rod)
    for step in range(half, 2 * points):
        j, after = step % points, (step + 1) % points
        known = d + dt * (_IMPLICIT * rod[after] + (1.0 - _IMPLICIT) * (rod[j] - u))
        for _ in range(_NEWTON_STEPS):
            pair = np.stack([u, u + nudge])
            excess = deflection(force(pair, after)) + _IMPLICIT * dt * pair - known
            change = np.clip(
                -excess[0] * nudge / (excess[1] - excess[0]), -5e5 * nudge, 5e5 * nudge
            )
            u = u + change
            if np.all(np.abs(change) < 0.1 * nudge):
                break
        d = deflection(force(u, after))
        path[after] = u
    return path.T.copy()
