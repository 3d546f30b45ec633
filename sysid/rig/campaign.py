"""A virtual campaign as files: raw data, manifest, table of tests, page, sealed truth."""

from collections.abc import Mapping
from typing import Any, Final

from sysid.rig.bench import Errors, Recording, Setting, run_test
from sysid.rig.chance import Stream
from sysid.rig.damper import HystereticDamper
from sysid.rig.excitation import SineRun
from sysid.rig.pages import dataset_page, manifest_text
from sysid.rig.scenario import Scenario
from sysid.rig.truth import Truth, seal

SEAL_FILE: Final = "sealed/truth.json"
_HEADER: Final = "time_s,displacement_mm,force_N,current_A,temperature_degC\n"
_ORDER_STREAM: Final = 1_000_000
"""Names the random numbers of the run order; tests are numbered from 0."""


def make_campaign(scenario: Scenario, seed: int | None = None) -> dict[str, bytes]:
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
    key = scenario.seed if seed is None else seed
    damper = HystereticDamper(scenario.parameters)
    order = Stream(key, _ORDER_STREAM).order(len(scenario.settings))
    files: dict[str, bytes] = {}
    table = ["file,amplitude_mm,frequency_Hz,current_A,run_order,kind\n"]
    tests: dict[str, Mapping[str, Any]] = {}
    for number, setting in enumerate(scenario.settings):
        recording, run, errors = run_test(damper, scenario.bench, setting, (key, number))
        stem = test_name(setting)
        files[f"{stem}.csv"] = _csv(recording)
        tests[stem] = _what_was_true(run, errors, setting)
        position = int(order[number]) + 1
        table.append(
            f"{stem}.csv,{1e3 * setting.amplitude:g},{setting.frequency:g},{setting.current:g},"
            f"{position},sine\n"
        )
    truth = Truth(scenario.id, key, "W11 Eqs. 3-10", dict(scenario.parameters), (), tests)
    sealed, digest = seal(truth)
    texts = {
        "tests.csv": "".join(table),
        "campaign.toml": manifest_text(scenario),
        "README.md": dataset_page(scenario, key, digest),
        SEAL_FILE: sealed,
    }
    return files | {name: text.encode("utf-8") for name, text in texts.items()}


def test_name(setting: Setting) -> str:
    """Stem of a test's file, such as ``12.5mm_1.5Hz_0.2A``."""
    return f"{1e3 * setting.amplitude:g}mm_{setting.frequency:g}Hz_{setting.current:g}A"


def _csv(recording: Recording) -> bytes:
    """The recorder's integers with their decimal points."""
    places = 3 if recording.rate <= 1000 else 4
    columns = (
        [f"{k / recording.rate:.{places}f}" for k in range(recording.force.size)],
        [f"{x / 1000:.3f}" for x in recording.displacement.tolist()],
        [f"{force / 10:.1f}" for force in recording.force.tolist()],
        [f"{current / 1000:.3f}" for current in recording.current.tolist()],
        [f"{temperature / 10:.1f}" for temperature in recording.temperature.tolist()],
    )
    rows = (",".join(row) for row in zip(*columns, strict=True))
    return (_HEADER + "\n".join(rows) + "\n").encode("ascii")


def _what_was_true(run: SineRun, errors: Errors, setting: Setting) -> dict[str, Any]:
    """What the seal keeps of one test, SI."""
    return {
        "amplitude": run.amplitude,
        "frequency": run.frequency,
        "current": setting.current,
        "centre": run.centre,
        "harmonics": [[h.order, h.size, h.lead] for h in run.harmonics],
        "gain": errors.gain,
        "offset": errors.offset,
        "delay": errors.delay,
        "noise": errors.noise,
        "temperature": errors.temperature,
    }
