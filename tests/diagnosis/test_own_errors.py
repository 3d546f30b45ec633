"""Rig errors act on the force that a model with its effects has."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.diagnosis.bases import fit_bases
from sysid.diagnosis.contenders import play, with_effect
from sysid.diagnosis.prototypes import prototypes
from sysid.diagnosis.selection import under_own_errors
from sysid.diagnosis.state import settle
from sysid.effects.registry import effect_kind, make
from sysid.likelihood.law_directions import force_by_laws
from sysid.models.coordinates import valve_at
from sysid.models.damper import Damper
from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import make_trial
from tests.diagnosis.diagnosed import BASE, DESIGN

DELAY = "late_sampling"


def based(trial):
    (base,) = fit_bases(trial.loops, BASE, seed=0, progress=lambda _: None)
    return base.evidence, settle(base.evidence, base.free.coordinates, base.free.u)


@pytest.fixture(scope="module")
def late():
    """Every test is sampled late, each by another time."""
    trial = make_trial(30049, (find_planter(DELAY),), (2.0,), DESIGN)
    evidence, base = based(trial)
    delay = make(effect_kind("force_delay"))
    extended = with_effect(base.coordinates, delay)
    state = settle(evidence, extended, np.append(base.u, 0.0), base.covariance)
    return trial, evidence, state


def delay_of(state, u):
    return valve_at(state.coordinates, u).effects[0].tau_F


def shares_of_tests(trial, evidence, state):
    """∂τ_F/∂τ_l, what a delay of each test alone adds to that of the campaign; and its sd."""
    force, points = trial.truth.force, trial.truth.force.shape[1]
    order = 1j * np.arange(points // 2 + 1)
    rate = np.fft.irfft(np.fft.rfft(force, axis=1) * order, points, axis=1)
    rate *= -2.0 * np.pi * trial.loops.frequency[:, None]
    slope = np.asarray(jax.grad(lambda u: delay_of(state, u))(jnp.asarray(state.u)))
    late = evidence.basis.compress(rate)
    jacobian, covariance = state.gls.jacobian, state.covariance
    direction = np.linalg.solve(covariance.inner(jacobian, jacobian), slope)
    weights = np.einsum("lmn,n->lm", jacobian, direction)
    shares = np.sum(covariance.weighted(weights[:, :, None])[:, :, 0] * late, axis=1)
    return shares, float(np.sqrt(slope @ direction))


def test_no_single_test_tells_the_delay_of_a_campaign(late):
    trial, evidence, state = late
    before, _ = shares_of_tests(trial, evidence, state)
    own, state = under_own_errors(evidence, state)
    after, sd = shares_of_tests(trial, own, state)
    assert np.abs(before).max() > 0.1  # under Σ of the base one test of many harmonics does
    assert np.abs(after).max() < 0.06
    assert after.sum() == pytest.approx(1.0, abs=0.05)
    scatter = state.sizes.delay * float(np.sqrt(np.sum(after**2)))
    assert sd > 0.9 * scatter  # what is told is no less than what the delays of tests leave open


def test_the_delay_is_told_within_its_interval(late):
    trial, evidence, state = late
    _, state = under_own_errors(evidence, state)
    _, sd = shares_of_tests(trial, evidence, state)
    found = float(delay_of(state, jnp.asarray(state.u)))
    assert found == pytest.approx(trial.truth.planters[0].size, abs=3.0 * sd)


def test_smoothness_of_the_laws_is_kept(late):
    _, evidence, state = late
    own, _ = under_own_errors(evidence, state)
    assert own.parts.lengths == evidence.parts.lengths
    np.testing.assert_array_equal(own.parts.kernel, evidence.parts.kernel)


@pytest.mark.parametrize("percent", [0.3, 2.0])
def test_a_limit_of_the_force_is_found_where_loops_end(percent):
    trial = make_trial(89, (find_planter("converter_limit"),), (percent,), DESIGN)
    evidence, base = based(trial)
    clipping = [e for e in prototypes(evidence.size) if e.facts.id == "force_clipping"]
    (found,) = play(evidence, base, clipping).contenders
    damper = valve_at(found.state.coordinates, jnp.asarray(found.state.u))
    limit = float(np.abs(trial.truth.force).max())
    assert 1.0 / float(vars(damper.effects[0])["q_F"]) == pytest.approx(limit, rel=0.015)


def test_an_error_of_the_valve_leaves_what_acts_beside_it(late):
    """Errors of a tenth in the valve's scale would else leave an inertia known to a tenth."""
    _, evidence, state = late
    valve = valve_at(state.coordinates, jnp.asarray(state.u)).valve
    motion, columns = evidence.motion, evidence.columns
    alone = np.asarray(force_by_laws(Damper(valve), motion, columns))
    inertia = make(effect_kind("fluid_inertia"))
    beside = np.asarray(force_by_laws(Damper(valve, (inertia,)), motion, columns))
    np.testing.assert_array_equal(beside, alone)
    late_force = Damper(valve, (make(effect_kind("force_delay")),))
    recorded = np.asarray(force_by_laws(late_force, motion, columns))
    expected = np.asarray(late_force.force(motion) @ columns)
    np.testing.assert_allclose(recorded, expected, atol=1e-9)
    assert np.abs(recorded - alone).max() > 1.0
