"""A small campaign on the physical damper, from settings to files."""

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from sysid.data.campaign import load_campaign
from sysid.data.cycles import cut_loops
from sysid.rig.bench import Plan
from sysid.rig.campaign import make_campaign
from sysid.rig.folder import write_folder
from sysid.rig.physical.campaign import Asked, run_campaign
from sysid.rig.scenarios import find_scenario
from sysid.rig.scenarios.physical_matrix_165 import PHYSICAL_MATRIX_165
from sysid.rig.scenarios.physical_sweep import PHYSICAL_SWEEP
from sysid.rig.truth import open_seal

EXCITATIONS = ((12.5e-3, 1.5), (2.5e-3, 10.0))
SMALL = replace(
    PHYSICAL_MATRIX_165,
    settings=tuple(Asked(a, f, i, 40.0) for (a, f), i in product(EXCITATIONS, (0.0, 0.3))),
    plan=Plan(rest=0.15, ramp_up=1.5, steady=4.0, ramp_down=1.0),
    points=200,
)
FOAMING = replace(
    SMALL,
    operator=replace(SMALL.operator, scatter=0.0),
    settings=tuple(
        Asked(2.5e-3, f, i, 40.0) for f, i in ((10.0, 0.4), (10.0, 0.1), (2.5, 0.4), (5.0, 0.3))
    ),
)


@pytest.fixture(scope="module")
def files() -> dict[str, bytes]:
    return make_campaign(SMALL)


@pytest.fixture(scope="module")
def folder(files, tmp_path_factory) -> Path:
    where = tmp_path_factory.mktemp("physical") / "campaign"
    write_folder(files, where)
    return where


def test_the_scenarios_are_what_they_say():
    matrix, sweep = PHYSICAL_MATRIX_165, PHYSICAL_SWEEP
    assert find_scenario("physical-matrix-165") is matrix
    assert find_scenario("physical-sweep") is sweep
    assert len({s.name for s in matrix.settings}) == len(matrix.settings) == 165
    assert len({s.name for s in sweep.settings}) == len(sweep.settings) == 168
    assert {s.temperature for s in sweep.settings} == {15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0}


def test_the_campaign_reads_without_a_remark(folder):
    campaign = load_campaign(folder)
    assert campaign.notes == ()
    loops = cut_loops(campaign.records)
    assert loops.left_out == {}
    assert len(loops.loops.ids) == 4


def test_force_grows_with_current_and_the_gas_carries_the_rod(folder):
    records = {record.id: record for record in load_campaign(folder).records}
    peaks = {name: np.ptp(record.force) / 2.0 for name, record in records.items()}
    assert peaks["12.5mm_1.5Hz_0.3A"] > 3.0 * peaks["12.5mm_1.5Hz_0A"]
    assert 200.0 < peaks["12.5mm_1.5Hz_0A"] < 450.0
    for record in records.values():
        assert 200.0 < np.mean(record.force[:20]) < 400.0


def test_the_truth_is_sealed_beside_it(folder):
    truth = open_seal(folder / "sealed" / "truth.json")
    assert truth.model == "physical damper"
    assert truth.parameters["valve.gap"] == pytest.approx(0.8e-3)
    assert {effect["id"] for effect in truth.effects} >= {"play", "gas_mixing", "entrained_air"}
    assert all(30.0 <= test["body_start"] <= 50.0 for test in truth.tests.values())
    hot = [t["oil_start"] - t["body_start"] for t in truth.tests.values()]
    assert max(hot) > 0.5


def test_the_bytes_depend_on_the_seed_only(files):
    assert make_campaign(SMALL) == files
    other = make_campaign(SMALL, seed=5)
    assert other.keys() == files.keys()
    assert other["12.5mm_1.5Hz_0A.csv"] != files["12.5mm_1.5Hz_0A.csv"]


def _widths(done, k: int) -> tuple[float, float]:
    """Of the loop, m/s, midway between its middle and its two plateaus."""
    recording, setting = done.recordings[k], FOAMING.settings[k]
    turns = (np.arange(recording.force.size) / recording.rate - 0.15) * setting.frequency
    cycle = (turns > 4.0) & (turns <= 5.0)
    force = recording.force[cycle] / 10.0
    speed = np.gradient(recording.displacement[cycle] / 1e6) * recording.rate
    middle, height = 0.5 * (force.max() + force.min()), 0.5 * np.ptp(force)
    widths = []
    for level in (middle + 0.5 * height, middle - 0.5 * height):
        above = force > level
        widths.append(float(np.ptp(speed[np.flatnonzero(above != np.roll(above, 1))])))
    return widths[0], widths[1]


def test_gas_mixing_widens_the_loop_in_compression_at_high_current_and_frequency():
    """W11 Fig. 4b: 2.5 mm, from 0.3 A and 10 Hz on."""
    done = run_campaign(FOAMING, 3)
    without = run_campaign(replace(FOAMING, levels={"gas_mixing": 0.0}), 3)
    own, off = _widths(done, 0), _widths(without, 0)
    assert own[0] > 1.06 * off[0]
    assert own[1] == pytest.approx(off[1], rel=0.03)
    foam = done.courses.foam.max(axis=0)
    assert foam[0] > 5e-3
    np.testing.assert_allclose(foam[1:], 0.0, atol=1e-4)
    assert without.courses.foam.max() == 0.0


def test_a_raised_mechanism_is_in_the_data_and_in_the_seal(files):
    raised = make_campaign(replace(SMALL, levels={"seal_friction": 3.0}))

    def low_speed_force(made):
        rows = made["12.5mm_1.5Hz_0A.csv"].decode().splitlines()[1:]
        force = np.array([float(row.split(",")[2]) for row in rows])
        return np.ptp(force) / 2.0

    # two times 50 N more on either side
    assert low_speed_force(raised) - low_speed_force(files) == pytest.approx(100.0, abs=15.0)
