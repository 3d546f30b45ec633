"""A quarter of a car on a road."""

import jax.numpy as jnp

from sysid.isolator.plant import Plant, output

BODY, WHEEL, SPRING, TYRE = 250.0, 35.0, 16.0e3, 160.0e3
"""kg, kg, N/m, N/m: a small car, 1.27 Hz and 11.3 Hz."""


def quarter_car(
    body: float = BODY, wheel: float = WHEEL, spring: float = SPRING, tyre: float = TYRE
) -> Plant:
    r"""Body and wheel with a spring and the damper between them, on a tyre.

        m_s ẍ_s = k_s (x_u − x_s) + F
        m_u ẍ_u = k_t (x_r − x_u) − k_s (x_u − x_s) − F,    x = x_u − x_s

    Args:
        body: m_s, kg.
        wheel: m_u, kg.
        spring: k_s, N/m.
        tyre: k_t, N/m.

    Returns:
        States x_s, ẋ_s, x_u, ẋ_u.
    """
    on_body = [-spring / body, 0.0, spring / body, 0.0]
    return Plant(
        matrix=jnp.asarray([
            [0.0, 1.0, 0.0, 0.0],
            on_body,
            [0.0, 0.0, 0.0, 1.0],
            [spring / wheel, 0.0, -(spring + tyre) / wheel, 0.0],
        ]),
        base=jnp.asarray([0.0, 0.0, 0.0, tyre / wheel]),
        rate=jnp.zeros(4),
        force=jnp.asarray([0.0, 1.0 / body, 0.0, -1.0 / wheel]),
        piston_displacement=output([-1.0, 0.0, 1.0, 0.0]),
        piston_velocity=output([0.0, -1.0, 0.0, 1.0]),
        body_velocity=output([0.0, 1.0, 0.0, 0.0]),
        relative_velocity=output([0.0, -1.0, 0.0, 1.0]),
        working_space=output([-1.0, 0.0, 1.0, 0.0]),
        acceleration=output(on_body, force=1.0 / body),
        tyre=output([0.0, 0.0, -1.0, 0.0], base=1.0),
    )  # fmt: skip
