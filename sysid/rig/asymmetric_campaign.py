"""A campaign whose current follows the direction of motion, as files."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Final

import numpy as np

from sysid.rig.asymmetric_drive import AsymmetricDrive, DrivenDamper
from sysid.rig.bench import PLAN, SAMPLING, Bench, Errors, Setting, set_up, what_was_true
from sysid.rig.chance import Stream
from sysid.rig.elementary import sine
from sysid.rig.excitation import SineRun
from sysid.rig.pages import dataset_page, scenario_manifest
from sysid.rig.recording import Recording, csv_text, digitise
from sysid.rig.scenario import Scenario
from sysid.rig.truth import SEAL_FILE, Truth, seal

_SETUP, _FORCE, _DISPLACEMENT, _CURRENT, _TEMPERATURE = range(5)
"""Streams of random numbers of one test."""
_ORDER_STREAM: Final = 1_000_000
"""Names the random numbers of the run order; tests are numbered from 0."""


@dataclass(frozen=True)
class AsymmetricCampaign:
    """A virtual campaign behind W11's asymmetric current.

    Attributes:
        design: Damper, tests, rig; its currents are those commanded, which is what is recorded.
        drive: What makes the coil's current of them.
    """

    design: Scenario
    drive: AsymmetricDrive

    @property
    def id(self) -> str:
        """Name on the command line, and of the dataset's folder."""
        return self.design.id

    @property
    def title(self) -> str:
        """Name of the campaign."""
        return self.design.title

    @property
    def settings(self) -> tuple[Setting, ...]:
        """The tests."""
        return self.design.settings

    @property
    def seed(self) -> int:
        """Of the random numbers."""
        return self.design.seed


def make_asymmetric(campaign: AsymmetricCampaign, seed: int | None = None) -> dict[str, bytes]:
    """Run all tests.

    As with `make_campaign`, the bytes depend on campaign and seed only.

    Args:
        campaign: What to run.
        seed: Of the random numbers; None for its own, which makes the shipped data.

    Returns:
        Path relative to the campaign's folder → content.
    """
    design = campaign.design
    key = design.seed if seed is None else seed
    order = Stream(key, _ORDER_STREAM).order(len(design.settings))
    files: dict[str, bytes] = {}
    table = ["file,amplitude_mm,frequency_Hz,current_A,run_order,kind\n"]
    tests: dict[str, Mapping[str, Any]] = {}
    for number, setting in enumerate(design.settings):
        recording, run, errors = _run_test(campaign, setting, (key, number))
        excitation = f"{1e3 * setting.amplitude:g}mm_{setting.frequency:g}Hz"
        stem = f"{excitation}_{setting.current:g}A"
        files[f"{stem}.csv"] = csv_text(recording)
        tests[stem] = what_was_true(run, errors, setting.current)
        table.append(
            f"{stem}.csv,{1e3 * setting.amplitude:g},{setting.frequency:g},{setting.current:g},"
            f"{int(order[number]) + 1},sine\n"
        )
    hidden = ({"id": "asymmetric_current", **asdict(campaign.drive)},)
    law = "W11 Eqs. 1-10"
    sealed, digest = seal(Truth(design.id, key, law, dict(design.parameters), hidden, tests))
    texts = {
        "tests.csv": "".join(table),
        "campaign.toml": scenario_manifest(design),
        "README.md": dataset_page(design, key, digest),
        SEAL_FILE: sealed,
    }
    return files | {name: text.encode("utf-8") for name, text in texts.items()}


def _run_test(
    campaign: AsymmetricCampaign, setting: Setting, key: tuple[int, ...]
) -> tuple[Recording, SineRun, Errors]:
    """What is recorded of one test, the true motion, the true errors."""
    bench, damper = campaign.design.bench, DrivenDamper(campaign.design.parameters)
    run, errors = set_up(bench, setting, PLAN, Stream(*key, _SETUP))
    rate = next(r for highest, r in SAMPLING if setting.frequency <= highest)
    count = int(run.duration * rate) + 1
    time = np.arange(count) / rate
    # the force channel is late: what it records now the damper did a moment ago
    coil = campaign.drive.current(run, -errors.delay, count, rate, setting.current)
    true = damper.force(run.state(time - errors.delay), coil)
    channel = (1.0 + errors.gain) * true + errors.offset
    steady = channel[run.steady_part(time)]
    noise = bench.force_noise * math.sqrt(math.fsum(steady * steady) / steady.size)
    errors = Errors(errors.gain, errors.offset, errors.delay, noise, errors.temperature)
    force = channel + noise * Stream(*key, _FORCE).normal(count)
    jitter = bench.displacement_noise * Stream(*key, _DISPLACEMENT).normal(count)
    current = setting.current + bench.current_noise * Stream(*key, _CURRENT).normal(count)
    warmth = _temperature(bench, errors, time / run.duration, Stream(*key, _TEMPERATURE))
    recording = Recording(
        rate=rate,
        displacement=digitise(1e6 * (run.state(time).displacement + jitter)),
        force=digitise(10.0 * force),
        current=digitise(1e3 * current),
        temperature=digitise(10.0 * warmth),
    )
    return recording, run, errors


def _temperature(bench: Bench, errors: Errors, share: np.ndarray, stream: Stream) -> np.ndarray:
    """A slow rise with a wave on it, and the thermocouple's noise, [n] °C."""
    wave = sine(share + stream.one_uniform())
    noise = bench.temperature_noise * stream.normal(share.size)
    return errors.temperature + bench.heating * (share + 0.3 * wave) + noise
