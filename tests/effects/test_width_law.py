"""A loop width that is a travel: the same at every amplitude and frequency."""

from typing import Literal

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.effects.law.width_law import AMPLITUDE, WidthLaw
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.motion.motion import sine_motion
from sysid.motion.time_motion import time_motion
from sysid.parameters import build

Part = Literal["whole", "yield"]
VALVE = build(Generalized, LOW_SYMMETRIC)
CONDITIONS = ((0.0025, 15.0), (0.005, 0.5), (0.0125, 1.0), (0.0125, 5.0), (0.05, 1.0))


def width_law(exponent: float, part: Part = "whole") -> WidthLaw:
    return WidthLaw(jnp.asarray(exponent), part=part)


def travel_to_zero(force: np.ndarray, displacement: np.ndarray) -> np.ndarray:
    """Travel from the reversal at the largest displacement to zero force, m."""
    found = []
    for F, x in zip(force, displacement, strict=True):
        start = int(np.argmax(x))
        after, travel = np.roll(F, -start), x.max() - np.roll(x, -start)
        k = int(np.argmax(after < 0.0))
        found.append(np.interp(0.0, [-after[k - 1], -after[k]], [travel[k - 1], travel[k]]))
    return np.array(found)


def travels(exponent: float, part: Part = "whole", current: float = 0.3) -> np.ndarray:
    amplitude, frequency = np.array(CONDITIONS).T
    motion = sine_motion(amplitude, frequency, current, points=1440)
    force = np.asarray(Damper(VALVE, (width_law(exponent, part),)).force(motion))
    return travel_to_zero(force, np.asarray(motion.displacement))


def test_one_half_is_a_constant_travel():
    """Over amplitudes 1 : 20, where without it the travel would grow twentyfold."""
    found = travels(0.5)
    np.testing.assert_allclose(found, found.mean(), rtol=0.1)
    h = travels(0.0)[-1] / CONDITIONS[-1][0]
    constant = (1.0 - (1.0 - h) ** 2) / 2.0 * AMPLITUDE
    assert found[-1] == pytest.approx(constant, rel=0.05), "that of the base at 10 mm"


def test_zero_is_a_travel_in_proportion_to_amplitude():
    amplitude = np.array(CONDITIONS)[:, 0]
    np.testing.assert_allclose(travels(0.0) / amplitude, travels(0.0)[0] / amplitude[0], rtol=1e-3)


def test_travel_goes_as_the_power_of_amplitude_that_is_claimed():
    amplitude = np.array(CONDITIONS)[:, 0]
    power = np.polyfit(np.log(amplitude), np.log(travels(0.25)), 1)[0]
    assert power == pytest.approx(1.0 - 2.0 * 0.25, abs=0.03)


def test_the_yield_part_alone_leaves_loops_without_field():
    motion = sine_motion(0.0025, 5.0, np.array([0.0, 0.3]))
    plain, changed = (
        VALVE.force(motion),
        Damper(VALVE, (width_law(0.5, "yield"),)).force(motion),
    )
    np.testing.assert_array_equal(plain[0], changed[0])
    assert np.abs(np.asarray(plain - changed)[1]).max() > 50.0


def test_other_motion_has_the_width_of_a_loop_at_its_reversals():
    """A sinusoid given as a time history: same force where the width counts, about zero force."""
    amplitude, frequency = 4.0 * AMPLITUDE, 1.0
    t = np.arange(720) / 360.0
    x = amplitude * np.sin(2.0 * np.pi * frequency * t)
    v = 2.0 * np.pi * frequency * amplitude * np.cos(2.0 * np.pi * frequency * t)
    a = -((2.0 * np.pi * frequency) ** 2) * x
    damper = Damper(VALVE, (width_law(0.5),))
    history = np.asarray(damper.force(time_motion(t, x, velocity=v, acceleration=a, current=0.3)))
    loop = np.asarray(damper.force(sine_motion(amplitude, frequency, 0.3)))[0]
    near = np.abs(np.cos(2.0 * np.pi * frequency * t[:360])) < 0.3
    peak = np.abs(loop).max()
    assert np.abs(history[360:] - loop)[near].max() < 0.03 * peak
    assert (
        np.abs(np.asarray(VALVE.force(sine_motion(amplitude, frequency, 0.3)))[0] - loop)[
            near
        ].max()
        > 0.1 * peak
    )
