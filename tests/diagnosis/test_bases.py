"""Which base models are tried when none is asked for."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sysid.data.campaign import load_campaign
from sysid.data.cycles import cut_loops
from sysid.data.loops import Loops
from sysid.diagnosis.bases import BASES, SWEPT, usual_bases
from sysid.identification.fit import fit_loops

DATASETS = Path(__file__).resolve().parents[2] / "datasets"


def shipped_loops(name: str) -> Loops:
    return cut_loops(load_campaign(DATASETS / name).records).loops


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
