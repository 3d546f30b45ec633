"""Planters whose effect the catalogue lacks, against closed forms of their physics."""

import numpy as np
import pytest

from sysid.rig.planters.outside_oil import CollapsingBubble, StickingPiston, ThixotropicOil
from sysid.rig.planters.outside_rig import RingingFixture, SlippingClamp
from tests.rig.bench_states import PHASE, Signal, added, one


def test_fixture_rings_at_its_resonance():
    state = one(1e-3, 20.0, valve=Signal(np.cos(PHASE)))
    ringing = RingingFixture(size=1.0 / (2.0 * np.pi * 20.0), damping=0.05)
    assert np.max(ringing.plant(state).force) == pytest.approx(10.0, rel=1e-3)


def test_clamp_holds_until_its_force_and_then_grows_slowly():
    state = one(12.5e-3, 2.5, 0.4)
    clamp = SlippingClamp(size=0.3)
    planted = clamp.plant(state)
    held = 0.7 * np.max(np.abs(state.force))
    low = np.abs(state.force) < held
    np.testing.assert_allclose(planted.force[low], state.force[low], rtol=0, atol=1e-5)
    slip = np.abs(state.velocity - planted.valve_velocity)
    sliding = slip > 1e-4
    expected = held * (1.0 + clamp.growth * np.arcsinh(slip[sliding] / clamp.slip_speed))
    np.testing.assert_allclose(np.abs(planted.force[sliding]), expected, rtol=1e-5)


def test_structure_is_torn_by_fast_motion_and_heals_in_slow():
    oil = ThixotropicOil()
    slow, fast = (oil.structure(one(a, f)) for a, f in ((0.1e-3, 0.1), (25e-3, 2.5)))
    assert np.min(slow) > 0.99
    power = oil.tearing * 4.0 * 25e-3 * 2.5
    assert np.mean(fast) == pytest.approx(1.0 / (1.0 + oil.recovery_time * power), rel=0.2)


def test_sticking_piston_burns_its_friction_over_its_travel():
    piston = StickingPiston()
    small, large = one(2.5e-3, 1.0), one(25e-3, 1.0)
    np.testing.assert_allclose(added(piston, small), 7200.0 * small.displacement[0], atol=1e-9)
    ends = np.max(added(piston, large))
    assert ends == pytest.approx(600.0 * 12.0 / 13.0 * (25e-3 + 0.05), rel=1e-6)
    travel = 4.0 * (25e-3 * 12.0 - 0.05) / 13.0
    work = np.mean(added(piston, large) * large.velocity[0])
    assert work == pytest.approx(600.0 * 0.05 * travel, rel=1e-3)


def test_hammer_of_joukowsky():
    bubble = CollapsingBubble()
    state = one(12.5e-3, 5.0)
    speed = np.interp(bubble.bubble, state.travel_since_reversal[0, 541:], state.velocity[0, 541:])
    assert np.max(added(bubble, state)) == pytest.approx(3e6 * speed * bubble.size, rel=0.02)
