"""Decoys score as chance does where Σ is right, and much where something strange is left."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import chdtri

from sysid.diagnosis.decoys import DECOYS, STRANGE, draw, patterns, score_decoys, strangest
from sysid.diagnosis.evidence import Evidence, gather
from sysid.diagnosis.parity import parity_shares
from sysid.diagnosis.plain import NONE
from sysid.diagnosis.state import State
from sysid.identification.problem import loop_problem
from sysid.likelihood.discrepancy import Covariance, Sizes
from sysid.likelihood.gls import GlsFit
from sysid.likelihood.reml import Restricted
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.models.generalized_coordinates import GeneralizedCoordinates
from tests.diagnosis.test_lack_of_fit import PHASE, campaign
from tests.likelihood.dense import dense

SIZES = Sizes(gain=0.01, offset=2.0, delay=1e-4, odd=0.03, even=0.01)
DRAWS = 60


@pytest.fixture(scope="module")
def model() -> Evidence:
    """A campaign whose measured force is the model's own."""
    return gather(
        campaign(lambda x, v, a, A, f, i: (200 + 1500 * i) * np.tanh(v / 0.01) + 300 * v, noise=5.0)
    )


def jacobian_of(evidence: Evidence) -> np.ndarray:
    loops, compress = evidence.loops, evidence.basis.compress
    step = np.tanh(loops.velocity / 0.01)
    current = loops.current[:, None]
    return np.stack([compress(z) for z in (step, current * step, loops.velocity)], axis=2)


def measured(evidence: Evidence, residual: np.ndarray) -> Evidence:
    """The same with a residual in the measurements."""
    return replace(evidence, measured=evidence.measured + residual)


def scores_of(evidence: Evidence, sizes: Sizes) -> list[np.ndarray]:
    """Scores of 300 decoys in each of many campaigns whose errors are those of `SIZES`."""
    root = np.linalg.cholesky(dense(evidence.parts, SIZES))
    random = np.random.default_rng(4)
    covariance = Covariance(evidence.parts, sizes)
    found = []
    for seed in range(DRAWS):
        r = (root @ random.standard_normal(root.shape[0])).reshape(evidence.measured.shape)
        decoys = draw(measured(evidence, r), r, count=300, seed=seed)
        found.append(score_decoys(decoys, r, jacobian_of(evidence), covariance))
    return found


def test_they_score_by_chance_where_the_covariance_is_right(model):
    """Each is χ²₁: its mean is one and a hundredth exceeds 6.63, averaged over campaigns."""
    scores = scores_of(model, SIZES)
    means = np.array([s.mean() for s in scores])
    assert means.mean() == pytest.approx(1.0, abs=4 * means.std() / np.sqrt(DRAWS))
    beyond = np.array([np.mean(s > chdtri(1, 0.01)) for s in scores])
    assert beyond.mean() == pytest.approx(0.01, abs=4 * beyond.std() / np.sqrt(DRAWS))
    assert beyond.mean() < 0.02


def test_they_score_more_where_errors_of_the_laws_are_not_modelled(model):
    blind = replace(SIZES, odd=0.0, even=0.0)
    right, wrong = (scores_of(model, s) for s in (SIZES, blind))
    assert np.mean([s.mean() for s in wrong]) > 5.0 * np.mean([s.mean() for s in right])
    assert np.median([s.max() for s in wrong]) > 5.0 * np.median([s.max() for s in right])


def state_of(evidence: Evidence, residual: np.ndarray, sizes: Sizes = SIZES) -> State:
    coordinates = GeneralizedCoordinates(loop_problem(evidence.loops).reference, "symmetric")
    jacobian = jacobian_of(evidence)
    gls = GlsFit(np.zeros(3), 1.0, residual, jacobian, np.eye(3), 1, True)
    covariance = Covariance(evidence.parts, sizes)
    fitted = Restricted(sizes, covariance, 0.0, np.zeros(8))
    return State(DamperCoordinates(coordinates, ()), gls, fitted, 0.0)


def test_a_strange_force_is_seen_and_noise_is_not(model):
    loops = model.loops
    # at 90° to any position and velocity, and only at speed
    strange = 90.0 * np.sin(3 * PHASE + 0.7) * (loops.frequency / 12.5)[:, None]
    root = np.linalg.cholesky(dense(model.parts, SIZES))
    noise = root @ np.random.default_rng(2).standard_normal(root.shape[0])
    r = noise.reshape(model.measured.shape)
    assert strangest(measured(model, r), state_of(model, r)) < 0.5 * STRANGE
    r = r + model.basis.compress(strange)
    assert strangest(measured(model, r), state_of(model, r)) > STRANGE


def test_without_a_covariance_nothing_is_said(model):
    r = model.basis.compress(np.ones_like(model.loops.force))
    assert strangest(measured(model, r), state_of(model, r, NONE)) == 0.0


def test_a_decoy_does_not_hold_the_residual_itself(model):
    """Of a model whose force is zero a decoy times its force is zero, whatever was measured."""
    decoys = draw(model, model.measured, count=20)
    assert np.abs(decoys[:, :, :10]).max() > 0.1
    np.testing.assert_array_equal(decoys[:, :, 10:], 0.0)


def test_what_the_model_absorbs_is_no_decoy(model):
    decoys = draw(model, np.zeros_like(model.measured), count=20)
    jacobian = decoys[:, :, :5]
    scores = score_decoys(decoys, model.measured, jacobian, Covariance(model.parts, SIZES))
    assert scores.size == 15


def test_patterns_have_the_parities_in_turn():
    found = patterns(np.random.default_rng(0), 10, PHASE)
    for k in range(10):
        shares = parity_shares(found[:, k][None, :])
        kind = ("OD", "OC", "EC", "ED", None)[k % 5]
        if kind is None:
            assert max(shares.values()) < 0.99
        else:
            assert shares[kind] == pytest.approx(1.0, abs=1e-12)


def test_the_same_decoys_each_time(model):
    none = np.zeros_like(model.measured)
    np.testing.assert_array_equal(draw(model, none, 30, seed=3), draw(model, none, 30, seed=3))
    assert draw(model, none).shape == (*none.shape, DECOYS)
