"""Correlation lengths of laws' errors: found again from draws, and what depends on them."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.likelihood.discrepancy import Covariance, Sizes
from sysid.likelihood.kernel import LENGTHS, WARM, Lengths, kernel_of
from sysid.likelihood.observed import Observed
from sysid.likelihood.reml import fit_sizes
from sysid.likelihood.smoothness import STEP, smoothness_and_sizes
from sysid.rig.trial_campaign import make_trial
from sysid.rig.trial_design import TrialDesign
from tests.likelihood.dense import draw
from tests.likelihood.on_the_model import COORDINATES, RIG, U, on_the_model

WRONG = replace(RIG, scale=0.02, width=0.02, growth=0.02)


@pytest.fixture(scope="module")
def ideal() -> Observed:
    return on_the_model(960_001)


def measured(ideal: Observed, sizes: Sizes, steps: tuple[int, ...], seed: int) -> Observed:
    """The tests with errors of Σ of such correlation lengths."""
    kernel = kernel_of(ideal.loops, lengths(steps))
    parts = replace(ideal.parts, kernel=kernel, error=np.inf)
    force, _ = ideal.look(COORDINATES, U)
    return replace(
        ideal, parts=replace(parts, kernel=ideal.parts.kernel),
        measured=ideal.measured - force + draw(parts, sizes, seed),
    )  # fmt: skip


def lengths(steps: tuple[int, ...]) -> Lengths:
    a, f, i = (float(length * STEP**n) for length, n in zip(LENGTHS, steps, strict=False))
    return a, f, i, LENGTHS[3]


def steps_of(found: Observed) -> tuple[int, ...]:
    """Which lengths were chosen."""
    steps = np.log(np.array(found.parts.lengths[:3]) / LENGTHS[:3]) / np.log(STEP)
    return tuple(steps.round().astype(int).tolist())


def test_a_supply_that_is_off_is_off_in_all_tests(ideal):
    """Errors of the laws at 10 µA are those at none."""
    off = replace(ideal.loops, current=np.zeros(len(ideal.loops.ids)))
    wander = 1e-5 * np.random.default_rng(1).standard_normal(len(off.ids))
    np.testing.assert_allclose(kernel_of(replace(off, current=wander)), kernel_of(off), rtol=1e-6)


@pytest.mark.parametrize("true", [(0, 0, 0), (2, 2, 2), (1, 4, 1)])
def test_lengths_are_found_again(ideal, true):
    """To a step, on average over four draws, in each direction."""
    found = [steps_of(smoothness_and_sizes(measured(ideal, WRONG, true, s), COORDINATES, U)[0])
             for s in range(4)]  # fmt: skip
    np.testing.assert_allclose(np.mean(found, axis=0), true, atol=1.01)


def test_exact_laws_leave_the_shortest(ideal):
    one = measured(ideal, RIG, (0, 0, 0), 3)
    found, restricted = smoothness_and_sizes(one, COORDINATES, U)
    assert steps_of(found) == (0, 0, 0)
    same, other = smoothness_and_sizes(lengthened(one), COORDINATES, U)
    assert steps_of(same) == (0, 0, 0), "lengths that it comes with do not matter"
    np.testing.assert_array_equal(same.parts.kernel, found.parts.kernel)
    assert other.log_likelihood == restricted.log_likelihood


def lengthened(one: Observed) -> Observed:
    """The same tests, as if their errors had been found to be twice as smooth."""
    longer = lengths((2, 2, 2))
    parts = replace(one.parts, lengths=longer, kernel=kernel_of(one.loops, longer))
    return replace(one, parts=parts)


def test_intervals_are_those_of_the_true_lengths_and_too_narrow_with_short_ones(ideal):
    """z² of parameters that the campaign determines, averaged over draws of smooth errors."""
    known = [COORDINATES.free.index(s) for s in ("F_0", "a_0", "k_1c", "k_4", "k_2")]
    true = (2, 3, 2)
    square: dict[str, list[np.ndarray]] = {"true": [], "found": [], "shortest": []}
    for seed in range(6):
        short = measured(ideal, WRONG, true, 100 + seed)
        kernel = kernel_of(ideal.loops, lengths(true))
        ways = {
            "true": replace(short, parts=replace(short.parts, kernel=kernel)),
            "found": smoothness_and_sizes(short, COORDINATES, U)[0],
            "shortest": short,
        }
        for name, one in ways.items():
            square[name].append(squares(one)[known])
    right, found, narrow = (float(np.mean(z)) for z in square.values())
    assert found < 1.5 * right
    assert narrow > 1.5 * right


def squares(one: Observed) -> np.ndarray:
    """(parameter − truth)² over its variance, for each."""
    residual, jacobian = one.look(COORDINATES, U)
    covariance = Covariance(one.parts, fit_sizes(one.parts, residual, jacobian).sizes)
    gram = covariance.inner(jacobian, np.concatenate([jacobian, residual[:, :, None]], axis=2))
    inverse = np.linalg.pinv(gram[:, :-1], hermitian=True)
    return (inverse @ gram[:, -1]) ** 2 / np.diagonal(inverse)


def test_the_kernel_is_that_of_the_lengths_it_names(ideal):
    """Twice the length in ln f is half of every ratio of frequencies."""
    loops = ideal.loops
    a, f, i, t = LENGTHS
    slower = replace(loops, frequency=np.sqrt(loops.frequency))
    np.testing.assert_allclose(kernel_of(loops, (a, 2 * f, i, t)), kernel_of(slower), rtol=1e-12)
    found = smoothness_and_sizes(measured(ideal, WRONG, (1, 4, 1), 0), COORDINATES, U)[0].parts
    np.testing.assert_array_equal(found.kernel, kernel_of(loops, found.lengths))


def test_the_kernel_goes_by_temperature_where_the_valve_has_laws_of_it():
    """And counts a temperature that nobody recorded as what models take for it."""
    loops = make_trial(960_002, design=TrialDesign(fewest=60, most=60)).loops
    warmer = replace(loops, temperature=loops.temperature + 50.0 * (np.arange(60) % 2))
    a, f, i, _ = LENGTHS
    np.testing.assert_array_equal(kernel_of(warmer), kernel_of(loops))
    one, other = kernel_of(warmer, (a, f, i, WARM)), kernel_of(loops, (a, f, i, WARM))
    assert one[0, 1] < 0.8 * other[0, 1]
    assert one[0, 2] == pytest.approx(other[0, 2])
    unknown = replace(loops, temperature=np.full(60, np.nan))
    np.testing.assert_array_equal(kernel_of(unknown, (a, f, i, WARM)), kernel_of(unknown))
