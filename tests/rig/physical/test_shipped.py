"""The shipped datasets of the physical damper: rebuilt byte for byte, and what they claim to be."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from sysid.data.campaign import Campaign, load_campaign
from sysid.data.quality import QualityReport, inspect
from sysid.rig.physical.campaign import PhysicalCampaign, run_campaign
from sysid.rig.physical.files import constants, files_of
from sysid.rig.physical.gas import ATMOSPHERE
from sysid.rig.physical.mechanisms import MECHANISMS
from sysid.rig.scenarios.physical import PHYSICAL
from sysid.rig.truth import Truth, open_seal

DATASETS = Path(__file__).parents[3] / "datasets"
REBUILT = {
    "virtual-matrix-165": ("2.5mm_15Hz_0.4A", "75mm_0.1Hz_0A"),
    "virtual-sweep": ("10mm_8Hz_1A_15C", "2.5mm_8Hz_0A_75C"),
}
"""Far apart in design and run order; two of each, so that all are solved by one program."""


@dataclass(frozen=True)
class Shipped:
    """A dataset as it lies in the repository."""

    scenario: PhysicalCampaign
    folder: Path
    truth: Truth
    campaign: Campaign
    report: QualityReport


@pytest.fixture(scope="module", params=PHYSICAL, ids=lambda scenario: scenario.dataset)
def shipped(request) -> Shipped:
    folder = DATASETS / request.param.dataset
    campaign = load_campaign(folder)
    truth = open_seal(folder / "sealed" / "truth.json")
    return Shipped(request.param, folder, truth, campaign, inspect(campaign))


def test_tests_rebuild_byte_for_byte_and_so_do_their_truths(shipped):
    """Without the others: what they leave behind in damper and rig is known beforehand."""
    scenario = shipped.scenario
    names = [setting.name for setting in scenario.settings]
    rebuilt = REBUILT[scenario.dataset]
    chosen = [names.index(name) for name in rebuilt]
    done = run_campaign(scenario, scenario.seed, chosen)
    made = files_of(scenario, scenario.seed, done)
    for name in rebuilt:
        assert made[f"{name}.csv"] == (shipped.folder / f"{name}.csv").read_bytes()
    assert made["campaign.toml"] == (shipped.folder / "campaign.toml").read_bytes()
    rows = (shipped.folder / "tests.csv").read_text().splitlines()
    assert set(made["tests.csv"].decode().splitlines()) <= set(rows)
    for name, true in zip(rebuilt, done.truths, strict=True):
        assert shipped.truth.tests[name] == true


def test_it_is_the_whole_design_in_one_order(shipped):
    names = {setting.name for setting in shipped.scenario.settings}
    assert {record.id for record in shipped.campaign.records} == names == set(shipped.truth.tests)
    assert shipped.campaign.notes == ()
    orders = [record.nominal.run_order for record in shipped.campaign.records]
    assert sorted(orders) == list(range(1, len(names) + 1))


def test_the_checks_find_nothing_but_notes_and_three_cycles(shipped):
    assert shipped.report.untrusted == ()
    assert {test.cycles for test in shipped.report.tests} == {3}
    faults = {(f.kind, f.severity) for test in shipped.report.tests for f in test.faults}
    assert faults <= {("aliasing", "note"), ("temperature_drift", "note")}


def test_the_seal_holds_the_damper_and_no_other_file_does(shipped):
    truth, folder = shipped.truth, shipped.folder
    assert truth.scenario == shipped.scenario.id
    assert truth.parameters == constants(shipped.scenario)
    assert [effect["id"] for effect in truth.effects] == [m.name for m in MECHANISMS]
    assert {effect["level"] for effect in truth.effects} == {1.0}
    sealed = json.loads((folder / "sealed" / "truth.json").read_text())
    assert sealed["sha256"] in (folder / "README.md").read_text(encoding="utf-8")
    for file in ("README.md", "campaign.toml", "tests.csv", "sealed/truth.json"):
        text = (folder / file).read_text(encoding="utf-8")
        for mechanism in MECHANISMS:
            assert mechanism.name not in text


def test_motion_and_temperature_are_those_of_the_seal(shipped):
    """The actuator follows its command but for what the force bends."""
    tests = {test.id: test for test in shipped.report.tests}
    for record in shipped.campaign.records:
        true, test = shipped.truth.tests[record.id], tests[record.id]
        assert test.frequency == pytest.approx(true["frequency"], rel=2e-3)
        assert test.amplitude == pytest.approx(true["amplitude"], rel=0.03)
        assert test.current == pytest.approx(true["current"], abs=1e-3)
        shown = np.mean(np.asarray(record.temperature)[:10])
        assert shown == pytest.approx(true["body_start"] + true["thermometer"], abs=0.1)


def test_before_the_motion_the_load_cell_shows_the_gas_on_the_rod(shipped):
    """(p − p_0) A_r of a gas that the warm oil squeezes, by the sealed constants alone."""
    told = shipped.truth.parameters
    volume, rod = told["gas.volume"], told["cylinder.rod"]
    wet = told["cylinder.far"] + told["cylinder.near"]
    for record in shipped.campaign.records:
        true = shipped.truth.tests[record.id]
        oil, body, centre = true["oil_start"], true["body_start"], true["centre"]
        grown = told["oil.expansion"] * (wet - rod * centre) * (oil - 20.0)
        now = volume - rod * centre - grown
        pressure = told["gas.charge"] * volume / now * (body + 273.15) / 293.15
        expected = (1.0 + true["gain"]) * (pressure - ATMOSPHERE) * rod + true["offset"]
        rest = record.force[record.time < 0.03]
        # wear takes at most a per cent of the gas in a campaign
        spread = 4.0 * shipped.scenario.channels.force_noise / np.sqrt(rest.size)
        assert expected - 0.012 * expected - spread < np.mean(rest) < expected + spread


def test_it_is_small(shipped):
    files = [path for path in shipped.folder.rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in files) < 4.6e6
