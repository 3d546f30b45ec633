"""A simulated hardware-in-the-loop test: a damper in a rig, the rest computed."""

from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np

from sysid.isolator.plant import MASS, NATURAL_FREQUENCY, Plant, output


@dataclass(frozen=True)
class Actuator:
    r"""Between wanted and real displacement of the piston.

        ẍ = ω² (x_c − x) − 2 ζ ω ẋ,    x_c = x_w + τ_c ẋ_w,    ω = 2 ζ / τ_a

    Slow motion comes late by τ_a − τ_c.

    Attributes:
        delay: τ_a, s.
        damping: ζ, dimensionless.
        compensation: τ_c, s.

    Source:
        A servo-hydraulic actuator under displacement control as a lag of second order; BS09 names
        its phase delay but no numbers.
    """

    delay: float = 5e-3
    damping: float = 0.7
    compensation: float = 0.0


def rig_isolator(actuator: Actuator, mass: float = MASS, stiffness: float | None = None) -> Plant:
    """The mass isolator, computed, with the damper in a rig behind an actuator.

    The computed mass feels the measured force; the damper moves as the actuator does.

    Args:
        actuator: The actuator.
        mass: kg.
        stiffness: Of the computed spring, N/m; that of 5 Hz where none is given.

    Returns:
        States x_m, ẋ_m, x, ẋ.
    """
    k = mass * (2.0 * np.pi * NATURAL_FREQUENCY) ** 2 if stiffness is None else stiffness
    z, late = actuator.damping, actuator.compensation
    omega = 2.0 * z / actuator.delay
    square = omega**2
    return Plant(
        matrix=jnp.asarray([
            [0.0, 1.0, 0.0, 0.0],
            [-k / mass, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
            [-square, -square * late, -square, -2.0 * z * omega],
        ]),
        base=jnp.asarray([0.0, k / mass, 0.0, square]),
        rate=jnp.asarray([0.0, 0.0, 0.0, square * late]),
        force=jnp.asarray([0.0, 1.0 / mass, 0.0, 0.0]),
        piston_displacement=output([0.0, 0.0, 1.0, 0.0]),
        piston_velocity=output([0.0, 0.0, 0.0, 1.0]),
        body_velocity=output([0.0, 1.0, 0.0, 0.0]),
        relative_velocity=output([0.0, -1.0, 0.0, 0.0], rate=1.0),
        working_space=output([-1.0, 0.0, 0.0, 0.0], base=1.0),
        acceleration=output([-k / mass, 0.0, 0.0, 0.0], base=k / mass, force=1.0 / mass),
        tyre=output([0.0] * 4),
    )  # fmt: skip
