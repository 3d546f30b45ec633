"""Which base models are tried when none is asked for."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.data.loops import Loops
from sysid.diagnosis.bases import (
    BASES,
    SWEPT,
    Base,
    admissible,
    by_rank,
    extendable,
    outdone,
    usual_bases,
)
from sysid.identification.fit import fit_loops
from sysid.identification.result import Fit
from sysid.models.coordinates import valve_at
from tests.data.shipped import shipped_loops
from tests.diagnosis.bare import bare


@pytest.fixture(scope="module")
def sweep() -> Loops:
    return shipped_loops("virtual-bs09-frequency")


def matrix(temperature_sd: float) -> Loops:
    """W11's matrix, at temperatures that scatter."""
    loops = shipped_loops("virtual-w11-low")
    random = np.random.default_rng(0)
    warm = 40.0 + temperature_sd * random.normal(size=len(loops.ids))
    return replace(loops, temperature=warm)


def test_the_lumped_model_is_tried_on_a_sweep_over_temperature(sweep):
    assert usual_bases(sweep) == (*BASES, SWEPT)


def test_a_sweep_without_current_is_one_however_its_meter_wanders(sweep):
    wander = 1e-5 * np.random.default_rng(2).standard_normal(len(sweep.ids))
    assert usual_bases(replace(sweep, current=wander)) == (*BASES, SWEPT)


def test_temperatures_that_scatter_over_a_matrix_are_no_sweep():
    loops = matrix(12.0)
    assert np.ptp(loops.temperature) > 40.0
    assert usual_bases(loops) == BASES


def test_where_temperature_is_unknown_there_is_no_sweep(sweep):
    unknown = replace(sweep, temperature=np.full(len(sweep.ids), np.nan))
    assert usual_bases(unknown) == BASES


def test_a_sweep_of_a_few_kelvin_is_none(sweep):
    cool = sweep.select(np.flatnonzero(sweep.temperature < 35.0))
    assert len(cool.ids) > 6
    assert usual_bases(cool) == BASES


@pytest.mark.slow
def test_on_a_sweep_the_lumped_model_errs_least(sweep):
    """In sample, beside the quickest of the others; neither has the static force of the gas."""
    some = sweep.select(np.arange(0, len(sweep.ids), 2))
    lumped, tanh = (
        fit_loops(some, model=name, weights="peak").mean_nrmse for name in (SWEPT[0], "tanh")
    )
    assert lumped < 0.7 * tanh


def test_bases_are_ranked_by_their_laws_and_not_by_a_static_force():
    """A base that leaves the preload to effects errs by it; another has wrong laws."""
    lawful = bare(Base, held_out=np.full(3, 0.21), shapes=np.full(3, 0.03))
    wrong = bare(Base, held_out=np.full(3, 0.08), shapes=np.full(3, 0.07))
    assert by_rank([wrong, lawful]) == (lawful, wrong)
    assert admissible((lawful, wrong)) == (lawful,)


def named(model: str, error: float, in_sample: float | None = None) -> Base:
    shapes = np.full(3, error)
    return bare(
        Base, fit=bare(Fit, model=model, variant=None), held_out=shapes, shapes=shapes,
        in_sample=error if in_sample is None else in_sample,
    )  # fmt: skip


def models_of(bases: tuple[Base, ...]) -> list[str]:
    return [b.fit.model for b in bases]


def test_beside_a_last_resort_with_memory_that_errs_one_without_is_extended():
    """Its state may only stand in for the springs, play and leaks of a damper without memory."""
    others = named("bouc_wen", 0.13), named("tanh", 0.14), named("generalized", 0.22)
    wrong = named("modified_bouc_wen", 0.047)
    assert models_of(extendable((wrong, *others), coarse=False)) == ["tanh", "modified_bouc_wen"]
    right = named("modified_bouc_wen", 0.011)
    assert models_of(extendable((right, *others), coarse=False)) == ["modified_bouc_wen"]
    usual = named("bouc_wen", 0.047)
    assert models_of(extendable((usual, *others[1:]), coarse=False)) == ["bouc_wen"]
    near = named("carreau", 0.05)
    found = extendable((wrong, near, *others), coarse=False)
    assert models_of(found) == ["carreau", "modified_bouc_wen"]


def test_a_last_resort_with_memory_is_extended_only_where_it_can_be_of_use():
    """It takes most of the time; a base that it does not beat with its effects needs no other."""
    wrong, right = named("modified_bouc_wen", 0.047), named("modified_bouc_wen", 0.011)
    assert outdone(wrong, 0.036)
    assert not outdone(wrong, 0.049)
    assert not outdone(wrong, np.inf)
    assert not outdone(right, 0.005), "the damper's own model is extended whatever else there is"
    assert not outdone(named("tanh", 0.047), 0.036), "as are bases that are no last resort"


def test_where_all_are_wrong_the_best_without_memory_is_extended():
    bases = named("dahl", 0.10), named("tanh", 0.12), named("generalized", 0.13)
    assert models_of(extendable(bases, coarse=True)) == ["tanh"]
    assert models_of(extendable((bases[0],), coarse=True)) == ["dahl"]


def test_a_constant_is_no_error_of_the_shape(evidence, base_state):
    damper = valve_at(base_state.coordinates, jnp.asarray(base_state.u))
    errors, shapes = evidence.errors_and_shapes(damper)
    pushed = replace(evidence, force=evidence.force + 500.0)
    more, same = pushed.errors_and_shapes(damper)
    np.testing.assert_allclose(same, shapes, rtol=1e-9)
    assert (more > errors).all()
