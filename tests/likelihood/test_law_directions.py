"""What an error of a base's laws would look like, beside a model that goes by its own state."""

import jax.numpy as jnp
import numpy as np

from sysid.likelihood.law_directions import WIDER, law_directions
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.models.lumped import TABLE_1, Lumped
from sysid.motion.motion import sine_motion
from sysid.parameters import build

LOOPS = sine_motion(
    np.array([0.01, 0.01, 0.005]), np.array([8.0, 8.0, 4.0]), np.array([0.0, 0.4, 1.0]),
    np.array([75.0, 15.0, 45.0]), points=72,
)  # fmt: skip
POINTS = jnp.eye(72)
"""Harmonics or points, the columns are all the same."""


def lumped(law: str, factor: float) -> np.ndarray:
    changed = {s: factor * z for s, z in TABLE_1.items() if s.startswith(law)}
    return np.asarray(build(Lumped, TABLE_1 | changed).force(LOOPS))


def test_of_the_lumped_model_they_are_another_spring_and_another_viscosity():
    damper = Damper(build(Lumped, TABLE_1))
    wider, thicker = np.asarray(law_directions(damper, LOOPS, POINTS))
    step = 1e-4
    softer = (lumped("k", 1.0 / (1.0 + step)) - lumped("k", 1.0 / (1.0 - step))) / (2 * step)
    viscous = (lumped("C_post", 1.0 + step) - lumped("C_post", 1.0 - step)) / (2 * step)
    for found, expected in ((wider, softer), (thicker, viscous)):
        assert np.abs(expected).max() > 100.0
        np.testing.assert_allclose(found, expected, atol=1e-3 * np.abs(expected).max())
    v = np.asarray(LOOPS.velocity)
    assert ((thicker * v).mean(axis=1) > 0.0).all()


def test_of_a_valve_without_state_they_are_a_shift_and_a_stretch_of_velocity():
    damper = Damper(build(Generalized, LOW_SYMMETRIC))
    wider, steeper = np.asarray(law_directions(damper, LOOPS, POINTS))
    force, step = np.asarray(damper.force(LOOPS)), 1e-6

    def at(velocity: jnp.ndarray) -> np.ndarray:
        motion = LOOPS.moved(LOOPS.displacement, velocity, LOOPS.acceleration)
        return np.asarray(damper.force(motion))

    moving = np.abs(LOOPS.velocity) > 1e-6  # at rest the force has a kink
    shift = WIDER * LOOPS.peak_velocity * LOOPS.acceleration_sign
    for found, change in ((wider, shift), (steeper, LOOPS.velocity)):
        expected = (at(LOOPS.velocity + step * change) - force) / step
        scale = np.abs(expected).max()
        np.testing.assert_allclose(found[moving], expected[moving], atol=1e-3 * scale)
