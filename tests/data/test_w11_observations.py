"""W11 §2.2's observations, read off loops of its own published model.

Only where reading.md trusts each set: Table 2 low at 12.5 mm up to 0.393 m/s, Table 2 high at
2.5 mm up to 0.236 m/s, Table 3 at 12.5 and 25 mm up to 0.236 m/s.  Each test says how far the
published model reproduces what the paper saw in the measurements.
"""

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.data.descriptors import Descriptors, describe
from sysid.models.generalized import (
    ASYMMETRIC,
    HIGH_SYMMETRIC,
    LOW_SYMMETRIC,
    Generalized,
)
from sysid.motion.motion import sine_motion
from tests.data.loop_of import loops_of


def observe(
    parameters: dict[str, float],
    amplitude: float | list[float],
    frequency: float | list[float],
    current: float | list[float],
) -> Descriptors:
    """Descriptors of the model's loops; mm, Hz, A, broadcast."""
    a, f, i = np.broadcast_arrays(
        *(np.atleast_1d(np.asarray(z, dtype=np.float64)) for z in (amplitude, frequency, current))
    )
    model = Generalized(**{name: jnp.asarray(value) for name, value in parameters.items()})
    force = np.asarray(model.force(sine_motion(1e-3 * a, f, i)))
    return describe(loops_of(force, 1e-3 * a, np.array(f), np.array(i)))


def test_knee_lies_about_25_mm_per_s() -> None:
    """Seen: the transition "occurs around the velocity 0.025 m/s".

    The model's knee is not one velocity: it is 2.2 (1 + k_0 v_m)/a_0, so proportional to peak
    velocity but for 2 mm/s.  It brackets 0.025 m/s between 0.5 and 1.5 Hz at 12.5 mm and passes
    through it near 1.2 Hz; at 5 Hz it is four times as high, which the paper does not say.
    """
    knee = observe(LOW_SYMMETRIC, 12.5, [0.5, 1.15, 1.5, 5.0], 0.2).knee_velocity
    assert knee[0] < 0.025 < knee[2]
    assert knee[1] == pytest.approx(0.025, rel=0.15)
    assert knee[3] == pytest.approx(0.096, rel=0.03)


@pytest.mark.parametrize("current", [0.0, 0.1, 0.2, 0.3, 0.4])
def test_loop_grows_nearly_linearly_with_frequency_below_10_hz(current: float) -> None:
    """Seen (Fig. 4, 2.5 mm): hysteresis grows nearly linearly below 10 Hz, more above.

    Reproduced: the width in force bends upwards, by under a tenth below 10 Hz.
    """
    frequency = [5.0, 7.5, 10.0, 12.5, 15.0]
    width = observe(HIGH_SYMMETRIC, 2.5, frequency, current).force_width
    step = np.diff(width)
    assert np.all(step > 0.0)
    assert np.all(np.diff(step) > 0.0)
    straight = 0.5 * (width[0] + width[2])
    assert width[1] == pytest.approx(straight, rel=0.02)


def test_intercept_grows_with_frequency_and_current() -> None:
    """v_h is proportional to v_m in the model, exactly linear in frequency, and grows with i."""
    by_frequency = observe(HIGH_SYMMETRIC, 2.5, [5.0, 10.0, 15.0], 0.1).velocity_intercept
    np.testing.assert_allclose(by_frequency / by_frequency[0], [1.0, 2.0, 3.0], rtol=1e-3)
    by_current = observe(LOW_SYMMETRIC, 12.5, 1.5, [0.0, 0.1, 0.2, 0.3, 0.4]).velocity_intercept
    assert np.all(np.diff(by_current) > 0.0)


def test_loop_grows_with_amplitude() -> None:
    """Seen (Fig. 5, 0.5 Hz): a larger amplitude widens the loop more.

    Only Table 3 was fitted on two amplitudes.  It reproduces the width in velocity, twice at twice
    the amplitude; its width in force at v = 0 does not grow, as v_b shifts the knee away from
    rest.
    """
    found = observe(ASYMMETRIC, [12.5, 25.0], 0.5, 0.2)
    assert found.velocity_width[1] / found.velocity_width[0] == pytest.approx(2.0, rel=0.03)
    assert found.force_width[1] < 1.02 * found.force_width[0]


def test_knee_at_0_a_fades_above_5_hz() -> None:
    """Seen: at 0 A, force is nearly linear in velocity above 5 Hz, the change of slope fades.

    Reproduced only in part: the damping before the knee over that behind it falls from 2.9 at 5 Hz
    to 2.6 at 10 Hz and then stays (5.8 at 12.5 mm, 0.5 Hz): the knee fades but does not vanish.
    """
    found = observe(HIGH_SYMMETRIC, 2.5, [5.0, 7.5, 10.0, 15.0], 0.0)
    change = found.pre_yield_damping / found.post_yield_damping
    assert np.all(np.diff(change[:3]) < 0.0)
    assert change[3] == pytest.approx(change[2], rel=0.05)
    assert np.all(change > 2.5)
    slow = observe(LOW_SYMMETRIC, 12.5, 0.5, 0.0)
    assert slow.pre_yield_damping[0] / slow.post_yield_damping[0] > 1.9 * change[0]


def test_force_at_0p1_hz_is_twice_what_is_called_seal_friction() -> None:
    """Measured at 0.1 Hz and 0 A, the force "is considered to represent the seal friction" F_0.

    The model saturates at F_t(0) = 2 F_0 there; F_0 itself is met only by an amplitude so low that
    the knee is not passed (2.5 mm: between F_0 and 2 F_0).
    """
    f_0 = LOW_SYMMETRIC["F_0"]
    wide = observe(LOW_SYMMETRIC, 12.5, 0.1, 0.0).peak_compression[0]
    assert wide == pytest.approx(2.0 * f_0, rel=0.10)
    small = observe(HIGH_SYMMETRIC, 2.5, 0.1, 0.0).peak_compression[0]
    assert HIGH_SYMMETRIC["F_0"] < small < 1.5 * HIGH_SYMMETRIC["F_0"]


def test_asymmetric_drive_gives_four_falling_towards_two() -> None:
    """Seen (§3, 0.3 A): rebound over compression of order 4 at low speed, about 2 at high speed.

    Reproduced by Table 3: 3.9 falling to 2.7 by the extremes of force.
    """
    found = observe(ASYMMETRIC, [12.5, 25.0, 12.5, 25.0], [0.5, 0.5, 1.5, 1.5], 0.3)
    assert found.asymmetry[0] == pytest.approx(3.9, abs=0.05)
    assert found.asymmetry[3] == pytest.approx(2.7, abs=0.05)
    assert np.all(np.diff(found.asymmetry) < 0.0)
