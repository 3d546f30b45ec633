"""The shipped sweeps over temperature: what they claim to be."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sysid.data.campaign import Campaign, load_campaign
from sysid.data.cycles import cut_loops
from sysid.data.manifest import Manifest
from sysid.data.quality import inspect
from sysid.data.record import Record
from sysid.diagnosis.tied import frequency_is_tied, untying_tests
from sysid.models.lumped import TABLE_1, Lumped
from sysid.models.simulate import simulate
from sysid.motion.motion import loop_motion
from sysid.parameters import build
from sysid.rig.truth import Truth, open_seal
from tests.data.shipped import shipped_loops

DATASETS = Path(__file__).parents[2] / "datasets"
SWEEPS = ("virtual-bs09", "virtual-bs09-frequency")
CURRENTS = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
LEVELS = (11.0, *np.arange(15.0, 76.0, 5.0).tolist())


@pytest.fixture(scope="module", params=SWEEPS)
def sweep(request) -> tuple[Campaign, Truth]:
    folder = DATASETS / request.param
    return load_campaign(folder), open_seal(folder / "sealed" / "truth.json")


def _labels(campaign: Campaign) -> set[tuple]:
    return {
        (1e3 * (n.amplitude or 0.0), n.frequency, n.current, n.temperature)
        for n in (record.nominal for record in campaign.records)
    }


def _design(excitations, currents, levels) -> set[tuple]:
    return {(*e, i, t) for e in excitations for i in currents for t in levels}


def test_the_first_set_has_the_tests_of_the_paper_and_some_for_validation(sweep):
    campaign, truth = sweep
    paper, separating = ((10.0, 8.0), (5.0, 4.0)), ((20.0, 4.0), (2.5, 8.0))
    if truth.scenario == "virtual-bs09":
        expected = _design(paper, CURRENTS, LEVELS) | _design(paper[:1], (2.0,), LEVELS)
        expected |= _design(separating, (0.0, 0.4, 1.0), (15.0, 75.0))
    else:
        telling = ((10.0, 2.0), (2.5, 8.0))
        expected = _design(paper + telling, CURRENTS, (15.0, 45.0, 75.0))
    rounded = {tuple(round(z, 9) for z in row) for row in _labels(campaign)}
    assert rounded == {tuple(round(z, 9) for z in row) for row in expected}
    assert len(campaign.records) == len(expected)
    assert campaign.notes == ()


def test_the_second_set_has_the_tests_that_the_paper_s_two_excitations_call_for():
    """`benchmarks/lumped_frequency.py` has what is found with them, and without."""
    loops = shipped_loops("virtual-bs09-frequency")

    def at(excitations) -> np.ndarray:
        motion = np.log(np.stack([loops.amplitude, loops.frequency], axis=1))
        return np.any([(np.abs(motion - np.log(z)) < 0.1).all(axis=1) for z in excitations], axis=0)

    paper = at(((10e-3, 8.0), (5e-3, 4.0)))
    assert frequency_is_tied(loops.select(paper))
    assert not frequency_is_tied(loops)
    np.testing.assert_array_equal(at(untying_tests(loops.select(paper))), ~paper)


def test_tests_with_laws_carried_beyond_the_table_are_marked(sweep):
    campaign, _ = sweep
    for record in campaign.records:
        beyond = (record.nominal.current or 0.0) > 1.0
        assert record.id.endswith("_extrapolated") == beyond


def test_the_default_reading_gives_the_same(sweep, tmp_path):
    campaign, truth = sweep
    folder = DATASETS / truth.scenario
    for file in ("tests.csv", *(record.source.file for record in campaign.records[::20])):
        (tmp_path / file).write_bytes((folder / file).read_bytes())
    (tmp_path / "tests.csv").unlink()
    plain = {record.id: record for record in load_campaign(tmp_path).records}
    for record in campaign.records[::20]:
        other = plain[record.id]
        np.testing.assert_array_equal(record.force, other.force)
        assert other.nominal.temperature == record.nominal.temperature
        assert other.nominal.current == record.nominal.current
    assert Manifest() != campaign.manifest


def test_temperature_wanders_between_and_during_tests(sweep):
    campaign, truth = sweep
    starts = np.array([truth.tests[r.id]["temperature"] for r in campaign.records])
    ends = np.array([truth.tests[r.id]["temperature_end"] for r in campaign.records])
    wanted = np.array([r.nominal.temperature for r in campaign.records])
    assert 0.5 < np.std(starts - wanted) < 1.5
    assert np.max(np.abs(starts - wanted)) < 3.5
    powerful = np.array([r.nominal.current == 1.0 for r in campaign.records])
    assert np.min(ends[powerful] - starts[powerful]) > 0.0
    assert np.max(ends - starts) > 0.5
    for record in campaign.records:
        true = truth.tests[record.id]
        shown = np.asarray(record.temperature) - true["thermometer"]
        low, high = sorted((true["temperature"], true["temperature_end"]))
        assert np.mean(shown[:20]) == pytest.approx(true["temperature"], abs=0.07)
        assert low - 0.07 < np.mean(shown[-20:]) < high + 0.07


def test_tests_are_run_from_cold_to_warm_in_random_order_of_current(sweep):
    campaign, _ = sweep
    orders = [record.nominal.run_order for record in campaign.records]
    assert orders == list(range(1, len(orders) + 1))
    first = [r for r in campaign.records if r.nominal.frequency == 8.0]
    first = [r for r in first if r.nominal.amplitude == 10e-3 and r.nominal.current != 2]
    levels = [r.nominal.temperature for r in first]
    assert levels == sorted(levels)
    currents = np.array([r.nominal.current for r in first]).reshape(-1, len(CURRENTS))
    assert len({tuple(row) for row in currents}) > 1


def test_only_the_second_set_hides_something_and_no_text_tells_what(sweep):
    campaign, truth = sweep
    folder = DATASETS / truth.scenario
    ids = [effect["id"] for effect in truth.effects]
    assert ids == (["frequency_law"] if "frequency" in truth.scenario else [])
    assert set(truth.tests) == {record.id for record in campaign.records}
    assert truth.parameters["C_post[0.8 A].slope"] == -8.91
    assert truth.parameters["F_y[0.2 A].intercept"] == 331.0
    assert truth.parameters["k.slope"] == 1.5e5
    sealed = json.loads((folder / "sealed" / "truth.json").read_text())
    assert sealed["sha256"] in (folder / "README.md").read_text(encoding="utf-8")
    for file in ("README.md", "campaign.toml", "tests.csv", "sealed/truth.json"):
        text = (folder / file).read_text(encoding="utf-8")
        for secret in ("1265", "6.78", "100000", "decade"):
            assert secret not in text


def _clean(record: Record, true: dict) -> Record:
    """The record without the sealed errors of its channels, and without the gas force."""
    force = (record.force - true["offset"]) / (1.0 + true["gain"])
    oil = np.asarray(record.temperature) - true["thermometer"]
    gas = 60.0 * (oil + 273.15) / 288.15
    # what is recorded now happened a moment ago
    x = np.interp(record.time - true["delay"], record.time, record.displacement)
    return replace(record, force=force - gas, displacement=x, temperature=oil)


def test_loops_are_those_of_the_fitted_model_within_the_noise(sweep):
    """All tests at 15 and 75 °C, apart from 2 A; the hidden law shows where it must."""
    campaign, truth = sweep
    records = [
        _clean(r, truth.tests[r.id])
        for r in campaign.records
        if r.nominal.temperature in (15.0, 75.0) and r.nominal.current != 2.0
    ]
    loops = cut_loops(records).loops
    assert len(loops.ids) == len(records)
    model = np.asarray(simulate(build(Lumped, TABLE_1), loop_motion(loops)))
    scale = np.sqrt(np.mean(model**2, axis=1))
    # at the peaks of speed, where the law is the yield force and the viscosity alone
    fast = np.abs(loops.velocity) > 0.8 * np.max(np.abs(loops.velocity), axis=1, keepdims=True)
    ratio = np.sum(loops.force * model * fast, axis=1) / np.sum(model**2 * fast, axis=1)
    if not truth.effects:
        error = np.sqrt(np.mean((loops.force - model) ** 2, axis=1)) / scale
        assert np.median(error) < 0.01
        assert np.max(error) < 0.035
        assert np.max(np.abs(ratio - 1.0)) < 0.01
    else:
        expected = 1.0 + 0.05 * np.log10(loops.frequency)
        assert np.max(np.abs(ratio / expected - 1.0)) < 0.01
        assert np.ptp(expected) > 0.014


def test_heating_records_go_from_15_to_75_degrees():
    folder = DATASETS / "virtual-bs09-heating"
    truth = open_seal(folder / "sealed" / "truth.json")
    assert len(truth.tests) == 3
    for true in truth.tests.values():
        assert true["temperature"] == pytest.approx(15.0, abs=2.0)
        assert true["temperature_end"] == pytest.approx(75.0, abs=2.0)


def test_heating_records_are_read_as_tests_at_twelve_or_more_temperatures():
    campaign = load_campaign(DATASETS / "virtual-bs09-heating")
    assert len(campaign.notes) == 3
    report = inspect(campaign)
    for current in (0.4, 0.6, 1.0):
        warm = [
            t.temperature for t in report.tests if t.current == pytest.approx(current, abs=0.01)
        ]
        assert len(warm) >= 12
        assert (np.diff(np.array(warm, dtype=float)) > 2.0).all()
    assert {fault.severity for test in report.tests for fault in test.faults} == {"note"}


def test_checks_find_nothing_in_the_sweeps_but_what_is_there(sweep):
    """The fluid's mass rings at up to 400 Hz, which 1250 samples a second hold only just."""
    report = inspect(sweep[0])
    found = {(fault.kind, fault.severity) for test in report.tests for fault in test.faults}
    assert found == {("aliasing", "note")}
    assert {test.cycles for test in report.tests} == {3}


def test_the_sweeps_are_small():
    for names, limit in ((SWEEPS, 9e6), (("virtual-bs09-heating",), 1.5e6)):
        files = [p for name in names for p in (DATASETS / name).rglob("*") if p.is_file()]
        assert sum(p.stat().st_size for p in files) < limit
