"""LuGre friction in its limits."""

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.rig.physical.friction import Seal

SEAL = Seal(
    sliding=40.0, breakaway=60.0, per_pressure=1e-5, stribeck_speed=5e-3,
    stiffness=5e5, damping=300.0, viscous=80.0,
)  # fmt: skip


@pytest.mark.parametrize("velocity", [-0.2, -4e-3, 1e-3, 5e-3, 0.1])
def test_in_steady_sliding_the_force_is_the_stribeck_curve(velocity):
    """ż = 0: F = sgn(v) g(v) + σ_2 v."""
    slip = 40.0 + 20.0 * np.exp(-((velocity / 5e-3) ** 2)) + 1e-5 * 2e6
    bend = jnp.asarray(np.sign(velocity) * slip / 5e5)
    force, bending = SEAL.sliding_at(jnp.asarray(velocity), bend, jnp.asarray(2e6))
    assert float(force) == pytest.approx(np.sign(velocity) * slip + 80.0 * velocity, rel=1e-12)
    assert float(bending) == pytest.approx(0.0, abs=1e-15)


def test_before_slipping_the_seal_is_a_spring():
    bend = 1e-6
    force, bending = SEAL.sliding_at(jnp.asarray(1e-9), jnp.asarray(bend), jnp.asarray(0.0))
    assert float(force) == pytest.approx(5e5 * bend, rel=1e-4)
    assert float(bending) == pytest.approx(1e-9 * (1.0 - 5e5 * bend / 60.0), rel=1e-6)


def test_a_part_without_mass_goes_where_force_and_friction_balance():
    seal = Seal(60.0, 60.0, 0.0, 1e9, 1e6, 300.0, 200.0)  # no Stribeck speed to fade with
    for force, bend in ((100.0, 3e-5), (-100.0, 3e-5), (20.0, -5e-5)):
        velocity, bending = seal.driven_by(jnp.asarray(force), jnp.asarray(bend))
        resisting, same = seal.sliding_at(velocity, jnp.asarray(bend), jnp.asarray(0.0))
        assert float(resisting) == pytest.approx(force, rel=1e-9)
        assert float(same) == pytest.approx(float(bending), rel=1e-9)


def test_held_by_less_than_friction_it_creeps_to_rest():
    """At F < F_c the bristles take the force up and the speed goes to 0."""
    velocity, _ = SEAL.driven_by(jnp.asarray(30.0), jnp.asarray(30.0 / 5e5))
    assert float(velocity) == pytest.approx(0.0, abs=1e-12)
