"""Delays beyond their first order: taken out of what is measured, and nothing else with them."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.likelihood.discrepancy import Covariance, Sizes
from sysid.likelihood.late import MOST, straightened
from sysid.likelihood.observed import Observed, observe
from sysid.models.coordinates import Reference
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.models.generalized_coordinates import GeneralizedCoordinates
from sysid.parameters import build
from sysid.rig.trial_campaign import make_trial
from sysid.rig.trial_design import TrialDesign

REFERENCE = Reference(force=1000.0, speed=0.4, current=0.4, length=0.025)
COORDINATES = GeneralizedCoordinates(REFERENCE, "symmetric")
U = np.asarray(COORDINATES.locate(build(Generalized, LOW_SYMMETRIC)))
DELAY = 1.2e-4
"""s, standard deviation over tests."""
SIZES = Sizes(gain=6e-3, offset=2.0, delay=DELAY)


@pytest.fixture(scope="module")
def ideal() -> Observed:
    """40 tests that the model itself measured, in time."""
    loops = make_trial(960_002, design=TrialDesign(fewest=40, most=40)).loops
    plain = observe(loops, points=72, harmonics=15)
    damper = Damper(build(Generalized, LOW_SYMMETRIC))
    seen = plain.beside(damper, plain.residual(COORDINATES, U))
    residual = seen.residual(COORDINATES, U)
    return replace(seen, measured=seen.measured - residual)


@pytest.fixture(scope="module")
def delays(ideal) -> np.ndarray:
    """s, of the tests, about none in the median."""
    delay = DELAY * np.random.default_rng(3).standard_normal(ideal.tests)
    fastest = 2.0 * np.pi * ideal.loops.frequency * ideal.basis.order.max()
    delay = np.clip(delay, -0.8 * MOST / fastest, 0.8 * MOST / fastest)
    return delay - np.median(delay)


def late(ideal: Observed, delay: np.ndarray) -> Observed:
    """The tests with their forces late: every harmonic turned, to all orders."""
    order = ideal.basis.order[1::2]
    theta = 2.0 * np.pi * (ideal.loops.frequency * delay)[:, None] * order
    lines = (ideal.measured[:, 1::2] - 1j * ideal.measured[:, 2::2]) * np.exp(-1j * theta)
    out = ideal.measured.copy()
    out[:, 1::2], out[:, 2::2] = lines.real, -lines.imag
    return replace(ideal, measured=out)


def straight(seen: Observed) -> Observed:
    covariance = Covariance(seen.parts, SIZES)
    return straightened(seen, covariance, seen.residual(COORDINATES, U))


def beyond_first_order(seen: Observed, ideal: Observed, delay: np.ndarray) -> np.ndarray:
    """χ² of what is measured about a force that is late to first order, [L]."""
    left = seen.measured - ideal.measured + delay[:, None] * ideal.parts.rate
    return np.sum(left**2, axis=1) / seen.parts.noise**2


def test_what_is_left_is_late_to_first_order(ideal, delays):
    seen = late(ideal, delays)
    before = beyond_first_order(seen, ideal, delays)
    after = beyond_first_order(straight(seen), ideal, delays)
    assert before.max() > 1.0, "or there is nothing to take out"
    assert after.max() < 0.02 * before.max()


def test_a_second_time_changes_nothing(ideal, delays):
    once = straight(late(ideal, delays))
    twice = straight(once)
    recorded = late(ideal, delays).measured
    for one in (once, twice):
        np.testing.assert_allclose(one.measured + one.bend, recorded, atol=1e-9)
    moved = np.abs(twice.measured - once.measured).max()
    assert moved < 0.02 * np.abs(once.bend).max()


def test_tests_in_time_are_left_as_they_are(ideal):
    np.testing.assert_allclose(straight(ideal).measured, ideal.measured, atol=1e-9)


def test_a_delay_of_all_tests_is_an_effect_of_its_own(ideal):
    """Only what differs from the campaign's own delay is taken out."""
    seen = late(ideal, np.full(ideal.tests, 2e-4))
    assert np.abs(straight(seen).bend).max() < 1e-3 * np.abs(seen.measured - ideal.measured).max()


def test_no_delay_is_believed_that_turns_the_highest_harmonic_by_too_much(ideal):
    far = np.zeros(ideal.tests)
    far[0] = 1.5 * MOST / (2.0 * np.pi * ideal.loops.frequency[0] * ideal.basis.order.max())
    free = replace(SIZES, delay=10.0 * far[0])
    seen = late(ideal, far)
    found = straightened(seen, Covariance(seen.parts, free), seen.residual(COORDINATES, U))
    assert not found.bend[0].any()
