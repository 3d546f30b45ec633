"""The screen names what was planted, stays silent where nothing was, and knows its limits."""

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.diagnosis.compress import harmonic_basis
from sysid.diagnosis.discrepancy import Covariance, Sizes, covariance_parts
from sysid.diagnosis.reml import full_rank
from sysid.diagnosis.screen import base_jacobian, prototypes, screen, shape_grid, signature
from sysid.effects.registry import EFFECTS, effect_kind, make
from sysid.identification.fit import fit_loops
from sysid.models.simulate import simulate
from sysid.motion.motion import loop_motion
from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import TrialDesign, make_trial

# Cheap to compile, and of four parities.
FEW = tuple(
    make(effect_kind(name))
    for name in ("force_offset", "gas_spring", "fluid_inertia", "position_friction",
                 "asymmetric_gain", "load_cell_gain")
)  # fmt: skip
BASIS = harmonic_basis(72)
# what the rig of the trials has: 0.6 % gain, 2 N offset, 0.1 ms delay from test to test
RIG = Sizes(gain=6e-3, offset=2.0, delay=1e-4, odd=1e-6, even=1e-6)


def screened(seed, planters=(), percents=None):
    trial = make_trial(seed, planters, percents, TrialDesign(fewest=66, most=66))
    fit = fit_loops(trial.loops, variant="symmetric")
    motion = loop_motion(trial.loops)
    residual = trial.loops.force - np.asarray(simulate(fit.valve, motion))
    jacobian = np.asarray(base_jacobian(fit.coordinates, jnp.asarray(fit.u), motion))
    compressed = np.moveaxis(BASIS.compress(np.moveaxis(jacobian, 2, 1)), 1, 2)
    covariance = Covariance(covariance_parts(trial.loops, BASIS), RIG)
    found = screen(fit, motion, residual, FEW, covariance, BASIS, full_rank(compressed))
    return found, trial


@pytest.mark.parametrize("seed", [11, 12, 13])
def test_nothing_planted_nothing_found(seed):
    found, _ = screened(seed)
    assert all(c.score < c.threshold for c in found.candidates)


@pytest.mark.parametrize(
    ("planter", "cause"),
    [
        ("gas_preload", "force_offset"),
        ("large_gas_chamber", "gas_spring"),
        ("oil_column", "fluid_inertia"),
        ("side_load", "position_friction"),
        ("bent_load_cell", "asymmetric_gain"),
    ],
)
def test_what_was_planted_comes_first(planter, cause):
    found, trial = screened(21, (find_planter(planter),), (2.0,))
    first = found.candidates[0]
    assert first.effect.facts.id == cause
    assert first.score > 5 * first.threshold
    assert cause in trial.truth.causes


def test_expected_size_is_near_the_planted_stiffness():
    """The linear part of a large gas chamber is a spring; the screen's own estimate finds it."""
    found, trial = screened(22, (find_planter("large_gas_chamber"),), (2.0,))
    spring = found.candidates[0]
    added = trial.truth.force - trial.truth.force_without
    x = trial.loops.displacement
    stiffness = float(np.sum(added * x) / np.sum(x * x))
    assert spring.expected == pytest.approx(stiffness, abs=4 * spring.standard_error)


def test_gain_of_the_load_cell_is_invisible():
    """The base model's own force scale absorbs it exactly."""
    found, _ = screened(11)
    gain = next(c for c in found.candidates if c.effect.facts.id == "load_cell_gain")
    assert not gain.visible
    assert gain.score == 0.0


def test_likeness_is_one_with_itself():
    found, _ = screened(11)
    visible = [k for k, c in enumerate(found.candidates) if c.visible]
    np.testing.assert_allclose(np.diagonal(found.likeness)[visible], 1.0, atol=1e-9)
    assert found.likeness.max() < 1.0 + 1e-9


def test_signature_of_a_spring_is_its_displacement():
    trial = make_trial(11, design=TrialDesign(fewest=66, most=66))
    fit = fit_loops(trial.loops, variant="symmetric")
    motion = loop_motion(trial.loops)
    found = signature(fit.valve, motion, make(effect_kind("gas_spring")))
    np.testing.assert_allclose(found, trial.loops.displacement, atol=1e-9)


def test_shapes_cover_their_realistic_range():
    bump_stop = make(effect_kind("bump_stop"))
    values = {float(e.x_b) for e in shape_grid(bump_stop)}
    low, high = bump_stop.facts.realistic["x_b"]
    assert {low, high} <= values
    assert len(shape_grid(make(effect_kind("gas_spring")))) == 1


def test_prototypes_are_the_effects_that_loops_can_show():
    ids = {e.facts.id for e in prototypes()}
    assert ids == {kind.facts.id for kind in EFFECTS if kind.facts.found_from == "loops"}
