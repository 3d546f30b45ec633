"""Play, air and lost motion in the valve: where and for how long force is missing."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.effects.base import Parts
from sysid.effects.law.valve_lost_motion import ValveLostMotion
from sysid.effects.motion.backlash import Backlash
from sysid.effects.motion.entrained_air import EntrainedAir
from sysid.effects.travel import travelled
from sysid.motion.motion import Motion, sine_motion
from sysid.motion.time_motion import time_motion

A = 0.01
POINTS = 720
LOOP = sine_motion(A, 1.0, 0.5, points=POINTS)
X, V = np.asarray(LOOP.displacement)[0], np.asarray(LOOP.velocity)[0]
TRAVEL = np.where(V > 0, X + A, A - X)
"""Since the last reversal."""
AWAY = np.abs(V) > 1e-6 * A
"""From the samples that lie on a reversal, half of which belongs to either stroke."""


def standing(motion: Motion) -> np.ndarray:
    return np.abs(np.asarray(motion.velocity)[0]) < 1e-9


@pytest.mark.parametrize("gap", [2e-4, 1e-3])
def test_backlash_holds_the_valve_after_both_reversals(gap):
    inner = Backlash(gap).at_valve(LOOP, lambda m: m.velocity)
    step = np.abs(V) / POINTS + 1e-6
    assert standing(inner)[(gap - step > TRAVEL) & AWAY].all()
    moving = (gap + step < TRAVEL) & AWAY
    np.testing.assert_allclose(np.asarray(inner.velocity)[0][moving], V[moving], rtol=1e-12)


def test_the_missing_travel_is_the_gap_at_any_sampling():
    """∫|v − v_v| dt over a cycle is 2 δ, also where δ is less than a sample's travel."""
    for points in (72, 360):
        motion = sine_motion(A, 1.0, 0.5, points=points)
        for gap in (3e-5, 1.7e-4, 8e-4):
            inner = Backlash(gap).at_valve(motion, lambda m: m.velocity)
            missing = jnp.sum(jnp.abs(motion.velocity - inner.velocity)) / points
            assert float(missing) == pytest.approx(2 * gap, rel=0.25)


@pytest.mark.parametrize("side", [1, -1])
def test_air_acts_on_one_side(side):
    inner = EntrainedAir(1e-3, side=side).at_valve(LOOP, lambda m: m.velocity)
    lost = standing(inner) & (np.abs(V) > 1e-3)
    assert lost.any()
    assert (V[lost] * side > 0).all()
    assert np.array_equal(inner.displacement, LOOP.displacement)


def parts_of(motion: Motion) -> Parts:
    sign = jnp.sign(motion.velocity)
    return Parts(yielding=1000.0 * motion.current * sign, viscous=100.0 * sign)


def test_valve_lost_motion_leaves_a_shelf_that_current_does_not_change():
    """Below the gap the force is the viscous one at any current; then it rises at 1/s_v."""
    gap, s = 1e-3, 1e-7
    for current in (0.5, 1.0):
        motion = eqx.tree_at(lambda m: m.current, LOOP, jnp.full((1, 1), current))
        force = np.asarray(ValveLostMotion(gap, s).parts(motion, parts_of).total)[0]
        shelf = (0.95 * gap > TRAVEL) & (0.05 * gap < TRAVEL)
        np.testing.assert_allclose(np.abs(force)[shelf], 100.0, atol=1e-6)
        take_up = s * 1000 * current
        after = (gap + take_up + 1e-4 < TRAVEL) & AWAY
        np.testing.assert_allclose(np.abs(force)[after], 100.0 + 1000 * current, rtol=1e-9)


def test_shelf_has_the_same_travel_at_every_frequency():
    shelves = []
    for frequency in (0.1, 1.0, 10.0):
        motion = sine_motion(A, frequency, 0.5, points=POINTS)
        force = np.asarray(ValveLostMotion(8e-4, 1e-8).parts(motion, parts_of).total)[0]
        shelves.append(TRAVEL[np.abs(force) < 101.0].max())
    assert np.ptp(shelves) < 1e-9
    assert shelves[0] == pytest.approx(8e-4, abs=1e-4)


def test_noise_does_not_count_as_reversals():
    """A ramp with steps back of 0.1 mm in a play of 0.5 mm: each costs no more than itself."""
    n = np.arange(300)
    x = 5e-5 * n - 1e-4 * (n % 10 == 9)
    motion = time_motion(n / 300.0, x, velocity=np.full(300, 0.015), acceleration=0.0 * x,
                         current=0.0)  # fmt: skip
    steps = travelled(motion, jnp.asarray(5e-4))
    forward = np.asarray(steps.moved)[20:] > 0.0
    used = np.asarray(steps.before)[20:][forward]
    assert used.min() == pytest.approx(5e-4 - 5e-5)
    assert (used == 5e-4).mean() > 0.6
