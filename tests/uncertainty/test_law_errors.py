"""Draws of errors of the laws against Σ written out, at fitted conditions and at one left out."""

import dataclasses

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.likelihood.compress import harmonic_basis
from sysid.likelihood.discrepancy import LAWS, Covariance, Sizes
from sysid.likelihood.observed import Observed, observe
from sysid.models.coordinates import valve_at
from sysid.models.damper import Damper
from sysid.motion.motion import loop_motion
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.law_errors import law_errors, rig_errors, steady_cycles, together
from tests.likelihood.dense import dense

SIZES = Sizes(
    gain=0.006, offset=1.0, delay=1e-4, odd=0.02, even=0.01,
    scale=0.02, width=0.03, steepness=0.02, growth=0.04,
)  # fmt: skip
LAWS_ALONE = dataclasses.replace(SIZES, gain=0.0, offset=0.0, delay=0.0)
DRAWS = 4000
POINTS = 72
LEFT_OUT = 4


def observed_of(made, loops) -> Observed:
    found = observe(loops, points=POINTS)
    u = made.errors.u
    residual = found.look(made.fit.coordinates, u)[0]
    return found.beside(Damper(valve_at(made.fit.coordinates, jnp.asarray(u))), residual)


def errors_of(made, loops) -> ErrorModel:
    found = observed_of(made, loops)
    covariance = Covariance(found.parts, SIZES)
    return dataclasses.replace(
        made.errors, kind="full", observed=found, sizes=SIZES, covariance=covariance
    )


@pytest.fixture(scope="module")
def whole(made):
    """Σ, its part of the laws, and a residual that has Σ."""
    parts = observed_of(made, made.loops).parts
    sigma = dense(parts, SIZES)
    quiet = dataclasses.replace(parts, noise=np.full(len(parts.noise), 1e-9))
    residual = np.linalg.cholesky(sigma) @ np.random.default_rng(1).standard_normal(len(sigma))
    return sigma, dense(quiet, LAWS_ALONE), residual.reshape(parts.force.shape)


def drawn(made, errors, residual, loops) -> np.ndarray:
    """[D, loop·m], harmonics of drawn errors."""
    wanted = steady_cycles(loop_motion(observe(loops, points=POINTS).loops))
    every = np.broadcast_to(residual, (DRAWS, *residual.shape))
    rng = np.random.default_rng(2)
    found = law_errors(errors, made.fit.coordinates, every, wanted, rng)
    force = found.at(slice(None), rng)
    return harmonic_basis(force.shape[2]).compress(force).reshape(DRAWS, -1)


def agree(draws, mean, covariance) -> None:
    sd = np.sqrt(np.diagonal(covariance))
    seen = sd > 1e-3 * sd.max()
    off = (draws.mean(axis=0) - mean)[seen] / sd[seen] * np.sqrt(DRAWS)
    assert np.sqrt(np.mean(off**2)) < 1.5
    assert np.median(draws.std(axis=0)[seen] / sd[seen]) == pytest.approx(1.0, abs=0.02)
    assert draws.std(axis=0)[seen] / sd[seen] == pytest.approx(np.ones(seen.sum()), abs=0.08)
    # not only point by point: a few random combinations, too
    some = np.random.default_rng(3).standard_normal((len(sd), 20))
    known = np.sqrt(np.einsum("ik,ij,jk->k", some, covariance, some))
    assert (draws @ some).std(axis=0) / known == pytest.approx(np.ones(20), abs=0.08)


def test_at_the_campaigns_own_tests_they_are_those_that_the_residual_leaves(made, whole):
    sigma, laws, residual = whole
    errors = errors_of(made, made.loops)
    draws = drawn(made, errors, residual, made.loops)
    mean = laws @ np.linalg.solve(sigma, residual.ravel())
    agree(draws, mean, laws - laws @ np.linalg.solve(sigma, laws))


def test_at_a_condition_left_out_they_are_told_by_its_neighbours(made, whole):
    sigma, laws, residual = whole
    kept = np.arange(len(made.loops.ids)) != LEFT_OUT
    errors = errors_of(made, made.loops.select(kept))
    draws = drawn(made, errors, residual[kept], made.loops.select(~kept))
    old = np.repeat(kept, residual.shape[1])
    across = laws[np.ix_(~old, old)]
    told = np.linalg.solve(sigma[np.ix_(old, old)], across.T)
    mean = told.T @ residual[kept].ravel()
    agree(draws, mean, laws[np.ix_(~old, ~old)] - across @ told)


def test_far_from_all_conditions_they_are_as_large_as_errors_of_laws_are_before_any_data(made):
    errors = errors_of(made, made.loops)
    away = dataclasses.replace(
        made.loops.select(np.array([0])), amplitude=np.array([1e3]), frequency=np.array([1e4])
    )
    seen = steady_cycles(loop_motion(away))
    wanted = dataclasses.replace(seen, amplitude=away.amplitude)
    residual = np.broadcast_to(0.0, (DRAWS, *errors.observed.measured.shape))
    rng = np.random.default_rng(2)
    found = law_errors(errors, made.fit.coordinates, residual, wanted, rng)
    scale = found.amplitudes[:, 0, -len(LAWS) :].std(axis=0)
    assert scale == pytest.approx([getattr(SIZES, law) for law in LAWS], rel=0.06)


def test_errors_of_the_rig_have_their_sizes(made):
    errors = errors_of(made, made.loops)
    wanted = steady_cycles(loop_motion(made.loops))
    rng = np.random.default_rng(4)
    found = rig_errors(errors, made.fit.coordinates, wanted, DRAWS, rng)
    sizes = found.amplitudes.std(axis=(0, 1))
    assert sizes == pytest.approx([SIZES.gain, SIZES.offset, SIZES.delay], rel=0.03)
    rate = np.gradient(found.directions[3, 0], 1.0 / made.loops.frequency[3] / 360)
    inner = slice(20, 160)  # away from the jumps at the reversals, which low harmonics round off
    error = np.abs(found.directions[3, 2] - rate)[inner]
    assert error.max() < 0.1 * np.abs(rate[inner]).max()
    # 2 % noise in each of four cycles
    rms = np.sqrt(np.mean(made.loops.force**2, axis=1))
    assert found.white / rms == pytest.approx(np.full(len(rms), 0.01), rel=0.1)
    both = together(found, rig_errors(errors, made.fit.coordinates, wanted, DRAWS, rng))
    assert both.at(slice(0, 2), rng).std() == pytest.approx(
        np.sqrt(2.0) * found.at(slice(0, 2), rng).std(), rel=0.1
    )


@pytest.mark.parametrize("share", [0.0, 0.1], ids=["newtons", "newtons and parts"])
def test_noise_is_that_of_the_test_or_of_tests_with_such_a_force(made, share):
    """Forty newtons in every test, alone or beside 10 %: 40 of 170 N are not 40 of 630."""
    rng = np.random.default_rng(5)
    loops, cycles = made.loops, 16
    rms = np.sqrt(np.mean(loops.force**2, axis=1))
    sd = np.hypot(40.0, share * rms)
    assert rms.max() > 3.0 * rms.min()
    scatter = [s * rng.standard_normal((cycles, loops.force.shape[1])) for s in sd]
    noisy = dataclasses.replace(
        loops,
        deviations=tuple(s - s.mean(axis=0) for s in scatter),
        cycles=np.full(len(loops.ids), cycles),
    )
    errors = errors_of(made, noisy)
    inside = steady_cycles(loop_motion(noisy))
    away = dataclasses.replace(inside, amplitude=1.1 * inside.amplitude)
    for wanted in (inside, away):
        found = rig_errors(errors, made.fit.coordinates, wanted, 2, rng).white
        assert found == pytest.approx(sd / np.sqrt(cycles), rel=0.1)


def test_a_test_that_is_louder_than_its_force_says_keeps_its_noise(made):
    rng = np.random.default_rng(6)
    loops, cycles = made.loops, 16
    sd = np.full(len(loops.ids), 10.0)
    sd[2] = 60.0
    scatter = [s * rng.standard_normal((cycles, loops.force.shape[1])) for s in sd]
    noisy = dataclasses.replace(
        loops,
        deviations=tuple(s - s.mean(axis=0) for s in scatter),
        cycles=np.full(len(loops.ids), cycles),
    )
    wanted = steady_cycles(loop_motion(noisy))
    found = rig_errors(errors_of(made, noisy), made.fit.coordinates, wanted, 2, rng).white
    quiet = np.delete(found, 2)
    assert found[2] / quiet == pytest.approx(np.full(len(quiet), 6.0), rel=0.2)


def test_a_likelihood_without_errors_of_laws_has_none_to_draw(made):
    wanted = steady_cycles(loop_motion(made.loops))
    residual = np.zeros((2, *made.errors.observed.measured.shape))
    with pytest.raises(ValueError, match="independent likelihood has no errors"):
        law_errors(made.errors, made.fit.coordinates, residual, wanted, np.random.default_rng(0))
