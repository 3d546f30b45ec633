"""A sweep over temperature as files: raw data, manifest, table of tests, page, sealed truth."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any, Final

from sysid.rig.bench import what_was_true
from sysid.rig.chance import Stream
from sysid.rig.recording import csv_text
from sysid.rig.sweep import Sweep, WarmSetting
from sysid.rig.sweep_pages import sweep_manifest, sweep_page
from sysid.rig.truth import SEAL_FILE, Truth, seal
from sysid.rig.warm_bench import WarmTest, run_warm_test

_ORDER_STREAM: Final = 1_000_000
_OPERATOR_STREAM: Final = 1_000_001
"""Name the random numbers of run order and operator; tests are numbered from 0."""


def make_sweep(sweep: Sweep, seed: int | None = None) -> dict[str, bytes]:
    """Run all tests of a sweep, one after the other on the same damper.

    As with `make_campaign`, the bytes depend on sweep and seed only.

    Args:
        sweep: What to run.
        seed: Of the random numbers; None for the sweep's own, which makes the shipped data.

    Returns:
        Path relative to the campaign's folder → content.
    """
    key = sweep.seed if seed is None else seed
    files: dict[str, bytes] = {}
    tests: dict[str, Mapping[str, Any]] = {}
    rows: dict[int, str] = {}
    operator = Stream(key, _OPERATOR_STREAM)
    before: float | None = None
    for position, number in enumerate(_order(sweep, key), start=1):
        setting = sweep.settings[number]
        start = _start(sweep, setting, before, operator)
        test = run_warm_test(sweep, setting, start, (key, number))
        before = float(test.course.oil[-1])
        stem = setting.name
        files[f"{stem}.csv"] = csv_text(test.recording)
        tests[stem] = _what_was_warm(test, setting)
        rows[number] = (
            f"{stem}.csv,{1e3 * setting.amplitude:g},{setting.frequency:g},{setting.current:g},"
            f"{'' if setting.wanders else f'{setting.temperature:g}'},{position},sine\n"
        )
    memory = sweep.damper.memory
    hidden = () if memory is None else ({"id": "frequency_law", **asdict(memory)},)
    parameters = sweep.damper.symbols() | asdict(sweep.heat)
    truth = Truth(sweep.id, key, "BS09 Table 1", parameters, hidden, tests)
    sealed, digest = seal(truth)
    head = "file,amplitude_mm,frequency_Hz,current_A,temperature_degC,run_order,kind\n"
    texts = {
        "tests.csv": head + "".join(rows[number] for number in sorted(rows)),
        "campaign.toml": sweep_manifest(sweep),
        "README.md": sweep_page(sweep, key, digest),
        SEAL_FILE: sealed,
    }
    return files | {name: text.encode("utf-8") for name, text in texts.items()}


def _order(sweep: Sweep, key: int) -> list[int]:
    """Numbers of the tests as they are run: the design's groups, each shuffled."""
    groups: dict[tuple[float, ...], list[int]] = {}
    for number, setting in enumerate(sweep.settings):
        group = (setting.amplitude, setting.frequency, setting.temperature)
        groups.setdefault(group, []).append(number)
    rank = Stream(key, _ORDER_STREAM).order(len(sweep.settings)).tolist()
    return [number for group in groups.values() for number in sorted(group, key=rank.__getitem__)]


def _start(sweep: Sweep, setting: WarmSetting, before: float | None, stream: Stream) -> float:
    """Temperature at which a test starts, °C."""
    operator, wanted = sweep.operator, setting.temperature
    set_to = wanted + operator.scatter * stream.one_normal()
    if before is None:
        return set_to
    rested = sweep.heat.rested(before, operator.pause)
    return rested if abs(rested - wanted) <= operator.tolerance else set_to


def _what_was_warm(test: WarmTest, setting: WarmSetting) -> dict[str, Any]:
    """What the seal keeps of one test, SI."""
    return what_was_true(test.run, test.errors, setting.current) | {
        "temperature_end": float(test.course.oil[-1]),
        "thermometer": test.thermometer,
    }
