"""Flow of a Herschel–Bulkley fluid through the narrow gap between two plates.

An annular gap is such a slot rolled up: where the gap is a few per cent of the radius, curvature
changes the flow by less than a thousandth (tests/rig/physical/test_slot_flow.py).

Shapes: all arrays are of one shape, […], a number for each of the tests that run side by side.
"""

import jax.numpy as jnp
from jax import Array

_SMALLEST = 1e-6
"""Pa; keeps a quotient of two stresses finite where nothing flows."""


def slot_flow(
    wall_stress: Array, yield_stress: Array, consistency: Array, exponent: Array, area: Array
) -> Array:
    r"""Flow through a slot w wide and h high, where a plug between two sheared layers moves.

    With m = 1/n and the excess S = |τ_w| − τ_y of the stress at the wall,

        Q = sgn τ_w · (w h²/2) · (S/K)^m · (S/τ_w²) · [S/(m+2) + τ_y/(m+1)],    0 where S ≤ 0.

    With n = 1 this is the cubic of Bingham's fluid, with τ_y = 0 the flow of a power-law fluid.

    Args:
        wall_stress: τ_w = h Δp / 2L, Pa.
        yield_stress: τ_y, Pa.
        consistency: K, Pa·sⁿ.
        exponent: n, 1 or less.
        area: w h², m³.

    Returns:
        Q, m³/s, in the direction of the pressure drop.

    Source:
        ∫ y γ̇ dy over the slot with γ̇ = ((τ − τ_y)/K)^m; Bird, Dai, Yarusso, The rheology and flow
        of viscoplastic materials, Rev. Chem. Eng. 1 (1983) 1–70, gives it for n = 1.
    """
    m = 1.0 / exponent
    size = jnp.abs(wall_stress)
    excess = jnp.maximum(size - yield_stress, 0.0)
    # where nothing flows the power's own derivative would be asked for at 0
    sheared = jnp.where(excess > 0.0, excess, 1.0) / consistency
    profile = excess / (m + 2.0) + yield_stress / (m + 1.0)
    flow = 0.5 * area * sheared**m * excess * profile / jnp.maximum(size, _SMALLEST) ** 2
    return jnp.sign(wall_stress) * jnp.where(excess > 0.0, flow, 0.0)


def power_law_stress(
    flow: Array, consistency: Array, exponent: Array, area: Array, slowest: Array
) -> Array:
    """Stress at the wall that drives a flow without yield stress: the inverse of `slot_flow`.

    τ_w = K γ̇ (γ̇² + γ̇_0²)^((n−1)/2) with γ̇ = (2n + 1)/n · 2Q/(w h²): below γ̇_0 the fluid thins
    no more and is Newtonian.

    Args:
        flow: Q, m³/s.
        consistency: K, Pa·sⁿ.
        exponent: n.
        area: w h², m³.
        slowest: γ̇_0, 1/s; 0 for a pure power law.
    """
    shear = (2.0 * exponent + 1.0) / exponent * 2.0 * flow / area
    return consistency * shear * (shear**2 + slowest**2) ** (0.5 * (exponent - 1.0))
