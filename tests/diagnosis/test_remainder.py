"""How much a model leaves beyond chance, and which part of it is an error of the valve's laws."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.diagnosis.evidence import gather
from sysid.diagnosis.ladder import shares
from sysid.diagnosis.remainder import lawful, remainder
from sysid.likelihood.discrepancy import Sizes
from sysid.likelihood.reml import fit_sizes
from sysid.models.coordinates import valve_at
from tests.likelihood.dense import draw

NONE = Sizes(gain=1e-4, offset=0.1, delay=1e-6)
LAWS_ERR = replace(NONE, scale=0.03, width=0.1)
OTHERWISE = replace(NONE, odd=0.02, even=0.02)


@pytest.mark.parametrize(
    ("sizes", "low", "high"),
    [
        pytest.param(LAWS_ERR, 0.9, 1.0, id="the laws"),
        pytest.param(OTHERWISE, 0.0, 0.3, id="another shape"),
    ],
)
def test_errors_of_the_laws_are_told_from_others(evidence, base_state, sizes, low, high):
    # drawn about the base model's force, so that the laws' directions are the damper's own
    damper = valve_at(base_state.coordinates, jnp.asarray(base_state.u))
    own = evidence.beside(damper, base_state.gls.residual)
    own = replace(own, parts=replace(own.parts, error=np.inf))
    r = draw(own.parts, sizes, seed=3)
    jacobian = base_state.gls.jacobian
    restricted = fit_sizes(own.parts, r, jacobian)
    state = replace(base_state, gls=replace(base_state.gls, residual=r), restricted=restricted)
    assert low <= lawful(own, state) <= high


RIG = Sizes(gain=6e-3, offset=2.0, delay=1e-4)


def fitted_to(evidence, state, error):
    """A state whose residual is what least squares leaves of an error, to first order."""
    peak = evidence.peak[:, None]
    A = (state.gls.jacobian / peak[:, :, None]).reshape(error.size, -1)
    b = (error / peak).ravel()
    left = (b - A @ np.linalg.lstsq(A, b, rcond=None)[0]).reshape(error.shape) * peak
    return replace(state, gls=replace(state.gls, residual=left))


def left_of(evidence, state, draws):
    errors = (draw(evidence.parts, RIG, seed=seed) for seed in range(draws))
    return [remainder(evidence, fitted_to(evidence, state, e), RIG) for e in errors]


@pytest.fixture(scope="module")
def left_by_the_rig(evidence, base_state):
    """What campaigns leave whose only errors are those of the rig, and what is expected."""
    return left_of(evidence, base_state, 60)


def test_a_fit_to_few_tests_leaves_less(evidence, base_state):
    """Thirteen parameters take up a third of the errors of eight tests."""
    some = np.arange(evidence.tests) % (evidence.tests // 8) == 0
    few = gather(evidence.loops.select(some))
    assert 6 <= few.tests <= 10
    gls = replace(base_state.gls, jacobian=base_state.gls.jacobian[some])
    found = left_of(few, replace(base_state, gls=gls), 200)
    totals = np.array([one.total for one in found])
    assert totals.mean() == pytest.approx(found[0].floor, rel=0.08)
    parts = few.parts
    bare = parts.noise**2 * parts.force.shape[1] + RIG.gain**2 * np.sum(parts.force**2, axis=1)
    bare += RIG.offset**2 + RIG.delay**2 * np.sum(parts.rate**2, axis=1)
    assert found[0].floor < 0.85 * np.sum(bare / few.peak**2)


def test_floor_and_scatter_are_those_of_many_campaigns(left_by_the_rig):
    totals = np.array([one.total for one in left_by_the_rig])
    expected = left_by_the_rig[0]
    sure = 4.0 * expected.scatter / np.sqrt(totals.size)
    assert totals.mean() == pytest.approx(expected.floor, abs=sure)
    assert totals.std() == pytest.approx(expected.scatter, rel=0.15)


@pytest.mark.parametrize(
    ("wide", "low", "high"),
    [pytest.param(1.0, 0.94, 1.0, id="chance"), pytest.param(1.7, 0.0, 0.1, id="more")],
)
def test_what_errors_of_the_rig_leave_may_be_chance(left_by_the_rig, wide, low, high):
    some = [replace(one, total=wide * one.total).may_be_chance for one in left_by_the_rig]
    assert low <= np.mean(some) <= high


@pytest.mark.parametrize(
    ("wide", "right", "explained"),
    [
        pytest.param(1.0, True, 1.0, id="chance, laws right"),
        pytest.param(1.0, False, 0.0, id="chance, laws wrong"),
        pytest.param(2.0, True, 0.0, id="more than chance"),
    ],
)
def test_an_effect_too_small_for_the_error_explains_all_only_beside_right_laws(
    evidence, base_state, wide, right, explained
):
    r = np.sqrt(wide * 1.05) * draw(evidence.parts, RIG, seed=1)
    state = fitted_to(evidence, base_state, r)
    found = shares(evidence, state, state, RIG, 0.5, right=lambda: right)
    assert found.explained == found.beside_laws == explained
