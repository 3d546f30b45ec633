"""Where a simulation is wrong, and with what the error grows: known errors, told as such."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis.exponents import Exponent
from sysid.diagnosis.where import SIDED, growth_words, where_wrong
from tests.report.made_diagnosis import made_loops


def cosine(points: int = 360) -> tuple[np.ndarray, np.ndarray]:
    phase = 2 * np.pi * np.arange(points) / points
    return np.cos(phase), np.sin(phase)


@pytest.mark.parametrize(
    ("shape", "sense", "region"),
    [
        (lambda v, x: 20 * np.sign(v), "too strong", "over the whole stroke"),
        (lambda v, x: -30 * v, "too weak", "at mid stroke"),
        (lambda v, x: 15 * x, "too stiff", "at the ends of the stroke"),
        (lambda v, x: np.full(v.size, -9.0), "too low", "over the whole stroke"),
        (lambda v, x: 50.0 * (v < 0) * (x > 0.99), "too stiff", "after the reversal at full com"),
        (
            lambda v, x: 50.0 * (x > 0.9) * (v < 0) - 50.0 * (x < -0.9) * (v > 0),
            "too stiff",
            "after ea",
        ),
        (lambda v, x: 8 * x * np.sign(v), SIDED[0], "at the ends of the stroke"),
        (lambda v, x: 5 * np.sin(12 * np.arctan2(x, v)), "wrong", "over the whole stroke"),
    ],
)
def test_place_and_sign_of_known_errors(shape, sense, region):
    loops = made_loops()
    v, x = cosine()
    truth = np.zeros_like(loops.force)
    simulated = truth.copy()
    simulated[4] = shape(v, x)
    found = where_wrong(loops, simulated, truth)
    assert (found.test, found.sense) == (4, sense)
    assert found.region.startswith(region)
    assert found.peak == pytest.approx(np.abs(simulated).max())


def test_too_little_force_after_a_reversal_is_too_soft():
    loops = made_loops()
    v, x = cosine()
    truth = np.tile(100.0 * v, (len(loops.ids), 1))
    gone = ((v < 0) & (x > 0.6)) | ((v > 0) & (x < -0.6))
    found = where_wrong(loops, truth * ~gone, truth)
    assert (found.sense, found.region) == ("too soft", "after each reversal")


def test_travel_is_that_of_the_rod():
    loops = made_loops()
    v, x = cosine()
    after = 40.0 * ((v < 0) & (x > 0.84))
    simulated = np.tile(after, (len(loops.ids), 1))
    found = where_wrong(loops, simulated, np.zeros_like(simulated))
    amplitude = loops.amplitude[found.test]
    assert found.travel == pytest.approx(0.16 * amplitude, rel=0.07)


def test_growth_follows_planted_exponents():
    loops = made_loops()
    size = 3.0 * loops.amplitude / 0.01 * (1.0 + 4.0 * loops.current)
    v, _ = cosine()
    simulated = size[:, None] * np.sign(v)[None, :]
    growth = where_wrong(loops, simulated, np.zeros_like(simulated)).growth
    assert "is the same at every frequency" in growth
    assert any(g.endswith("amplitude") and g.startswith("grows in proportion") for g in growth)
    assert any("current" in g and g.startswith("grows") for g in growth)


def test_the_worst_test_may_be_the_slowest_where_the_error_grows_with_frequency():
    """Largest in newtons at the large amplitude; what grows is told with all else equal."""
    loops = made_loops()
    slow = loops.amplitude == loops.amplitude.max()
    loops = replace(loops, frequency=np.where(slow, 0.1, loops.frequency))
    size = (loops.amplitude / 0.01) ** 4 * loops.frequency**0.7
    simulated = size[:, None] * np.sign(cosine()[0])[None, :]
    found = where_wrong(loops, simulated, np.zeros_like(simulated))
    assert loops.frequency[found.test] == 0.1
    assert any(g.startswith("grows with") and "frequency" in g for g in found.growth)


def test_an_error_that_changes_with_temperature():
    loops = made_loops()
    truth = np.tile(100.0 * cosine()[0], (len(loops.ids), 1))
    warm = np.linspace(20.0, 60.0, len(loops.ids))
    loops = replace(loops, temperature=np.random.default_rng(2).permutation(warm))
    share = 0.01 * (loops.temperature - 40.0)
    told = "changes with temperature"
    assert told in where_wrong(loops, truth * (1.0 + share[:, None]), truth).relative
    assert told not in where_wrong(loops, truth + 5.0, truth).relative
    assert told not in where_wrong(loops, truth * 1.1, truth).relative


def test_open_exponents_are_left_out():
    nan = float("nan")
    found = (
        Exponent("amplitude", 2.05, 1.9, 2.2),
        Exponent("frequency", nan, nan, nan),
        Exponent("current", 0.4, -0.5, 1.3),
    )
    assert growth_words(found) == ("grows with the square of amplitude",)
    assert growth_words((Exponent("current", -0.8, -1.5, -0.1),)) == ("falls with current",)
    assert growth_words((Exponent("current", 0.2, 0.1, 0.3),)) == ("hardly depends on current",)
