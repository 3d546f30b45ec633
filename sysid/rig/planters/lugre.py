"""LuGre friction: bristles that bend, creep and slip, solved as a differential equation."""

import numpy as np
from jaxtyping import Float

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.periodic import periodic_recurrence

Grid = Float[np.ndarray, "loop phase"]

_SMALLEST = 1e-6
"""Slip force kept where a contact opens, N."""


def lugre_force(
    state: BenchState,
    slip: Grid,
    stiffness: float,
    damping: float = 0.0,
) -> Grid:
    """Friction on the rod in the steady state, [L, P] N.

        ż = v − σ_0 |v| z / g,  F = σ_0 z + σ_1 ż

    Between two points of the grid the rod moves by a known travel and g is constant; there the
    equation is linear in z along the travel and solved exactly.

    Args:
        state: The tests.
        slip: g, force in steady sliding, [L, P] or [L, 1] N, not negative.
        stiffness: σ_0, N/m.
        damping: σ_1, N·s/m.

    Source:
        Canudas de Wit, Olsson, Åström, Lischinsky, A new model for control of systems with
        friction, IEEE Trans. Automatic Control 40 (1995) 419–425.
    """
    if not np.any(slip):
        return np.zeros_like(state.force)
    g = np.maximum(np.broadcast_to(slip, state.displacement.shape), _SMALLEST)
    travel = np.roll(state.displacement, -1, axis=1) - state.displacement
    midway = 0.5 * (g + np.roll(g, -1, axis=1))
    kept = np.exp(-np.minimum(stiffness * np.abs(travel) / midway, 700.0))
    z = periodic_recurrence(kept, midway / stiffness * np.sign(travel) * (1.0 - kept))
    v = state.velocity
    return stiffness * z + damping * (v - stiffness * np.abs(v) * z / g)
