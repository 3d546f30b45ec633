"""A virtual campaign as files: raw data, manifest, table of tests, page, sealed truth."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Final

from sysid.rig.asymmetric_campaign import AsymmetricCampaign
from sysid.rig.asymmetric_drive import AsymmetricDrive
from sysid.rig.bench import Setting, run_test, what_was_true
from sysid.rig.chance import Stream
from sysid.rig.damper import HystereticDamper
from sysid.rig.pages import dataset_page, scenario_manifest
from sysid.rig.recording import csv_text
from sysid.rig.scenario import Scenario
from sysid.rig.sweep import Sweep
from sysid.rig.sweep_campaign import make_sweep
from sysid.rig.truth import SEAL_FILE, Truth, seal

if TYPE_CHECKING:
    from sysid.rig.physical.campaign import PhysicalCampaign

_ORDER_STREAM: Final = 1_000_000
"""Names the random numbers of the run order; tests are numbered from 0."""


def make_campaign(
    scenario: "Scenario | Sweep | AsymmetricCampaign | PhysicalCampaign", seed: int | None = None
) -> dict[str, bytes]:
    """Run all tests of a scenario.

    The bytes depend on scenario and seed only, not on machine, processor or version of numpy:
    integers from seeded bit generators, and arithmetic that IEEE 754 rounds the same everywhere
    (`sysid.rig.elementary`).

    Args:
        scenario: What to run.
        seed: Of the random numbers; None for the scenario's own, which makes the shipped data.

    Returns:
        Path relative to the campaign's folder → content.
    """
    if isinstance(scenario, Sweep):
        return make_sweep(scenario, seed)
    if isinstance(scenario, AsymmetricCampaign):
        hidden = {"id": "asymmetric_current", **asdict(scenario.drive)}
        return _on_the_bench(scenario.design, seed, scenario.drive, "W11 Eqs. 1-10", (hidden,))
    if not isinstance(scenario, Scenario):
        from sysid.rig.physical.files import make_physical

        return make_physical(scenario, seed)
    return _on_the_bench(scenario, seed)


def _on_the_bench(
    scenario: Scenario,
    seed: int | None,
    drive: AsymmetricDrive | None = None,
    law: str = "W11 Eqs. 3-10",
    hidden: tuple[Mapping[str, Any], ...] = (),
) -> dict[str, bytes]:
    """Files of W11's damper on the bench, its current driven as it is asked for or otherwise."""
    key = scenario.seed if seed is None else seed
    damper = HystereticDamper(scenario.parameters)
    order = Stream(key, _ORDER_STREAM).order(len(scenario.settings))
    files: dict[str, bytes] = {}
    table = ["file,amplitude_mm,frequency_Hz,current_A,run_order,kind\n"]
    tests: dict[str, Mapping[str, Any]] = {}
    for number, setting in enumerate(scenario.settings):
        recording, run, errors = run_test(damper, scenario.bench, setting, (key, number), drive)
        stem = test_name(setting)
        files[f"{stem}.csv"] = csv_text(recording)
        tests[stem] = what_was_true(run, errors, setting.current)
        position = int(order[number]) + 1
        table.append(
            f"{stem}.csv,{1e3 * setting.amplitude:g},{setting.frequency:g},{setting.current:g},"
            f"{position},sine\n"
        )
    truth = Truth(scenario.id, key, law, dict(scenario.parameters), hidden, tests)
    sealed, digest = seal(truth)
    texts = {
        "tests.csv": "".join(table),
        "campaign.toml": scenario_manifest(scenario),
        "README.md": dataset_page(scenario, key, digest),
        SEAL_FILE: sealed,
    }
    return files | {name: text.encode("utf-8") for name, text in texts.items()}


def test_name(setting: Setting) -> str:
    """Stem of a test's file, such as ``12.5mm_1.5Hz_0.2A``."""
    return f"{1e3 * setting.amplitude:g}mm_{setting.frequency:g}Hz_{setting.current:g}A"
