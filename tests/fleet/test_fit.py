"""Dampers fitted side by side are the dampers fitted alone."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.errors import FitError
from sysid.fleet.chunks import Chunk, chunk_jobs, fit_chunk
from sysid.fleet.fit import fit_fleet
from sysid.fleet.single import fit_of
from sysid.identification.fit import fit_loops
from sysid.identification.result import Result
from sysid.jobs.job import Here
from sysid.jobs.run import run_jobs
from sysid.parameters import as_dict
from tests.fleet.dampers import TESTS, damper

FEWER = TESTS[[0, 1, 2, 3, 4, 5, 8]]


@pytest.fixture(scope="module")
def fleet():
    """Five dampers; one has fewer tests than the others."""
    return [damper(0), damper(1), damper(2, tests=FEWER), damper(3), damper(4)]


@pytest.fixture(scope="module")
def found(fleet):
    return fit_fleet(fleet)


def test_the_minimum_is_that_of_the_single_fit(fleet, found):
    for k in (0, 3):
        alone = fit_loops(fleet[k])
        assert found.results[k] is alone.result is Result.converged
        assert found.cost[k] == pytest.approx(alone.cost, rel=1e-6)
        assert np.allclose(found.nrmse[k], [t.nrmse for t in alone.tests], rtol=1e-3)
        ours, single = as_dict(found.valve(k)), as_dict(alone.valve)
        for symbol in ("F_0", "a_1", "a_0", "k_4", "k_1c"):  # those that such tests determine
            assert ours[symbol] == pytest.approx(single[symbol], rel=1e-3), symbol


def test_eight_starts_that_agree_are_the_evidence(found):
    assert set(found.starts) == {8}
    assert all(len(b) == 1 and b[0].hits == 8 for b in found.basins)
    assert np.all(found.steps > 8 * 5)


def test_a_damper_does_not_depend_on_the_others(fleet, found):
    again = fit_fleet([fleet[4], fleet[0]], threads=2)
    assert again.cost == pytest.approx(found.cost[[4, 0]], rel=1e-9)
    assert [r.size for r in found.rmse] == [9, 9, 7, 9, 9]


def test_one_damper_is_taken_out_as_a_fit_of_its_own(fleet, found):
    one = fit_of(found, 2, fleet[2])
    assert one.result is Result.converged
    assert one.starts == 8
    assert [t.nrmse for t in one.tests] == pytest.approx(found.nrmse[2])
    squares = sum(t.rmse**2 * fleet[2].force.shape[1] for t in one.tests)
    assert squares == pytest.approx(one.cost)
    assert one.mean_nrmse == pytest.approx(0.0075, abs=0.002)


def test_chunks_are_jobs_whose_names_say_what_they_depend_on(fleet, found, tmp_path):
    names = [f"serial-{k}" for k in range(5)]

    def run(dampers):
        return run_jobs(
            chunk_jobs(names, dampers, size=3), fit_chunk, Here(), tmp_path / "rows.jsonl",
            lambda row: row.get("key"), prepare=lambda: None, tell=lambda *_: None,
        )  # fmt: skip

    done = run(fleet)
    rows = [row for chunk in done.rows.values() for row in chunk["dampers"]]
    assert [row["name"] for row in rows] == names
    assert [row["cost"] for row in rows] == pytest.approx(found.cost.tolist(), rel=1e-9)
    assert rows[4]["parameters"]["F_0"] == pytest.approx(float(found.valve(4).F_0), rel=1e-6)
    changed = replace(fleet[4], force=fleet[4].force + 1.0)
    assert run([*fleet[:4], changed]).new == 1, "one chunk of two has other forces"
    assert Chunk(("a",), (fleet[0],)).key != Chunk(("a",), (fleet[0],), weights="peak").key


def test_what_cannot_be_fitted_is_said(fleet):
    with pytest.raises(FitError, match="loops have 72 and 90 points"):
        fit_fleet([fleet[0], damper(0, points=90)])
    with pytest.raises(FitError, match="no test is left to fit"):
        fit_fleet([fleet[0], fleet[1].select(np.zeros(9, dtype=bool))])
    unknown = replace(fleet[1], current=np.full(9, np.nan))
    with pytest.raises(FitError, match="current is not known"):
        fit_fleet([fleet[0], unknown])
    with pytest.raises(ValueError, match="cannot agree"):
        fit_fleet(fleet, starts=2)


def test_a_chunk_is_told_from_one_that_gives_another_result(fleet):
    loops = fleet[0]
    keys = {
        Chunk(("d",), (changed,)).key
        for changed in (
            loops,
            replace(loops, noise_floor=2.0 * loops.noise_floor),
            replace(loops, displacement=1.01 * loops.displacement),
            replace(loops, current=loops.current + 0.01),
        )
    }
    assert len(keys) == 4
    assert Chunk(("d",), (loops,)).key in keys
    assert Chunk(("d",), (loops,), weights="noise").key not in keys
