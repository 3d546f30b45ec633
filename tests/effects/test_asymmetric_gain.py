"""Valves answer to where the rod goes, load cells to whether they are pressed or pulled."""

import jax.numpy as jnp
import numpy as np

from sysid.effects.channel.asymmetric_gain import AsymmetricGain
from sysid.motion.motion import sine_motion

PHASE = 2.0 * np.pi * np.arange(360) / 360.0
LOOP = sine_motion(0.01, 2.0, 0.2, points=360)
FORCE = jnp.asarray(500.0 * np.cos(PHASE - 0.3)[None])  # behind the velocity, as a loop is
GAIN = 0.03


def test_a_load_cell_is_as_wrong_at_a_force_wherever_the_rod_goes():
    recorded = np.asarray(AsymmetricGain(GAIN, turns="force").recorded(FORCE, LOOP))[0]
    force = np.asarray(FORCE)[0]
    pulled = force > 0.0
    np.testing.assert_allclose(recorded[pulled], (1.0 + GAIN) * force[pulled], rtol=1e-12)
    np.testing.assert_allclose(recorded[~pulled], (1.0 - GAIN) * force[~pulled], rtol=1e-12)


def test_the_two_forms_differ_only_between_reversal_and_zero_force():
    of_force, of_velocity = (
        np.asarray(AsymmetricGain(GAIN, turns=turns).recorded(FORCE, LOOP))[0]
        for turns in ("force", "velocity")
    )
    force, velocity = np.asarray(FORCE)[0], np.asarray(LOOP.velocity)[0]
    between = force * velocity < 0.0
    fast = np.abs(velocity) > 3e-3
    assert 0.05 < between.mean() < 0.15  # twice the angle of lag of the circle
    np.testing.assert_allclose(of_force[~between & fast], of_velocity[~between & fast], rtol=1e-8)
    apart = (of_force - of_velocity)[between & fast]
    np.testing.assert_allclose(apart, 2.0 * GAIN * np.abs(force)[between & fast], rtol=1e-8)
