"""A campaign on the physical damper: settings, protocol, run order, all tests, files."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, Final

import jax
import numpy as np

from sysid.rig.bench import Bench, Errors, Plan, Setting, set_up
from sysid.rig.chance import Stream
from sysid.rig.excitation import SineRun
from sysid.rig.physical.channels import Channels, record
from sysid.rig.physical.course import POINTS, Courses, Outset, run_tests
from sysid.rig.physical.damper import PhysicalDamper
from sysid.rig.physical.history import (
    run_order,
    slid_before,
    temperatures,
    worn,
    yield_stresses,
)
from sysid.rig.physical.mechanisms import at_levels
from sysid.rig.physical.warming import Operator
from sysid.rig.recording import Recording

_ORDER, _OPERATOR, _SETUP = 1_000_000, 1_000_001, 0
"""Name random numbers: of the run order, of the operator, of one test's set-up."""
PLAN: Final = Plan(rest=0.04, ramp_up=0.5, steady=3.5, ramp_down=0.5)
"""Three whole steady cycles and half of one to spare: the data are small enough to be shipped."""


@dataclass(frozen=True)
class Asked:
    """What the operator asks for.

    Attributes:
        amplitude: m.
        frequency: Hz.
        current: A.
        temperature: Of the body, °C.
        labelled: Whether the file's name tells the temperature.
    """

    amplitude: float
    frequency: float
    current: float
    temperature: float
    labelled: bool = False

    @property
    def name(self) -> str:
        """Stem of the test's file, such as ``12.5mm_1.5Hz_0.2A``."""
        words = [f"{1e3 * self.amplitude:g}mm", f"{self.frequency:g}Hz", f"{self.current:g}A"]
        return "_".join([*words, f"{self.temperature:g}C"] if self.labelled else words)

    @property
    def rate(self) -> int:
        """Sampling rate, Hz: 156 to 200 a cycle, so that times have at most four decimals."""
        return next(rate for highest, rate in SAMPLING if self.frequency <= highest)


SAMPLING: Final[tuple[tuple[float, int], ...]] = (
    (0.1, 16), (0.5, 80), (1.5, 250), (2.5, 400), (4.0, 625), (5.0, 1000), (8.0, 1250),
    (12.5, 2000), (math.inf, 2500),
)  # fmt: skip
"""Highest frequency (Hz) → sampling rate (Hz)."""


@dataclass(frozen=True)
class PhysicalCampaign:
    """A campaign, complete but for its random numbers.

    Attributes:
        id: Name on the command line.
        title: Name of the campaign.
        about: For the dataset's page; no parameter values.
        limits: Lines of the manifest's table [limits].
        damper: As built.
        settings: The tests; those of one temperature are run in random order, warmer ones later.
        seed: Of the random numbers.
        operator: What happens between tests.
        levels: Mechanism → level, where not 1.
        bench: Sizes of the errors that differ by test; noise is that of `channels`.
        channels: The measuring chain.
        thermometer_sd: Error of the thermocouple by test, K.
        plan: Rest, ramps, cycles.
        points: Steps a cycle.
    """

    id: str
    title: str
    about: str
    limits: str
    damper: PhysicalDamper
    settings: tuple[Asked, ...]
    seed: int
    operator: Operator
    levels: Mapping[str, float] = field(default_factory=dict)
    bench: Bench = field(
        default_factory=lambda: Bench(second_harmonic=5e-4, third_harmonic=1e-3, delay_sd=5e-5)
    )
    channels: Channels = field(default_factory=Channels)
    thermometer_sd: float = 0.3
    plan: Plan = PLAN
    points: int = POINTS

    @property
    def dataset(self) -> str:
        """Name of the folder under `datasets/`, such as ``virtual-sweep``."""
        return f"virtual-{self.id.removeprefix('physical-')}"


@dataclass(frozen=True)
class Prepared:
    """Everything about a campaign that is known before its tests are run, in design order.

    Attributes:
        damper: As each test finds it: constants that wear changes have one value for each.
        runs: True commands to the actuator.
        errors: Of the force channel.
        thermometer: Error of the thermocouple, K.
        outset: State at the start.
        positions: Place of each test in the run order, from 1.
    """

    damper: PhysicalDamper
    runs: tuple[SineRun, ...]
    errors: tuple[Errors, ...]
    thermometer: tuple[float, ...]
    outset: Outset
    positions: tuple[int, ...]


@dataclass(frozen=True)
class TestsRun:
    """Tests of a campaign that were run.

    Attributes:
        tests: Their places in the design.
        recordings: In the order of `tests`, as are the next two.
        truths: What was true of each test, SI and °C.
        courses: What happened.
        prepared: The whole campaign.
    """

    tests: tuple[int, ...]
    recordings: tuple[Recording, ...]
    truths: tuple[dict[str, Any], ...]
    courses: Courses
    prepared: Prepared


def run_campaign(
    campaign: PhysicalCampaign, key: int, only: Sequence[int] | None = None
) -> TestsRun:
    """Run tests: the history of the damper first, then all at once.

    What a test inherits from those before it is worked out in advance: the way its seal has slid
    and the currents its iron has seen, exactly; its temperature from the operator's protocol.

    Args:
        campaign: What to run.
        key: Of the random numbers.
        only: Places in the design of the tests that are wanted; None for all. They come out as
            they do among all others.
    """
    prepared = prepare(campaign, key)
    tests = tuple(range(len(campaign.settings)) if only is None else only)
    which = np.array(tests)
    outset = Outset(*(getattr(prepared.outset, f.name)[which] for f in fields(Outset)))
    damper = jax.tree.map(lambda leaf: leaf[which], prepared.damper)
    courses = run_tests(damper, [prepared.runs[k] for k in tests], outset, campaign.points)
    recordings = recorded(campaign, prepared, key, tests, courses)
    truths = tuple(
        _what_was_true(campaign.settings[k], prepared, k, courses, column)
        for column, k in enumerate(tests)
    )
    return TestsRun(tests, recordings, truths, courses, prepared)


def prepare(campaign: PhysicalCampaign, key: int) -> Prepared:
    """Draw all errors and work out what each test inherits from those before it."""
    damper = at_levels(campaign.damper, campaign.levels)
    settings = campaign.settings
    wanted = np.array([setting.temperature for setting in settings])
    current = np.array([setting.current for setting in settings])
    order = run_order(wanted, Stream(key, _ORDER))
    runs, errors, thermometer = zip(
        *(_draw(campaign, setting, (key, k)) for k, setting in enumerate(settings)), strict=True
    )
    oil, body = temperatures(campaign.operator, damper.heat, wanted, order, Stream(key, _OPERATOR))
    stress = yield_stresses(damper, current, order)
    positions = np.empty(len(order), int)
    positions[order] = np.arange(1, len(order) + 1)
    return Prepared(
        damper=worn(damper, slid_before(runs, order)),
        runs=runs,
        errors=errors,
        thermometer=thermometer,
        outset=Outset(stress, current**2 * damper.magnet.resistance, oil, body),
        positions=tuple(positions.tolist()),
    )


def recorded(
    campaign: PhysicalCampaign,
    prepared: Prepared,
    key: int,
    tests: Sequence[int],
    courses: Courses,
) -> tuple[Recording, ...]:
    """What the recorder stores of tests.

    Args:
        campaign: What was run.
        prepared: Its errors.
        key: Of the random numbers.
        tests: Places in the design.
        courses: What happened in them, in the same order.
    """
    lag = float(campaign.damper.heat.thermocouple)
    return tuple(
        record(
            campaign.channels,
            courses,
            column,
            prepared.runs[k],
            campaign.settings[k].rate,
            campaign.settings[k].current,
            lag,
            prepared.errors[k],
            prepared.thermometer[k],
            (key, k),
        )
        for column, k in enumerate(tests)
    )


def _draw(
    campaign: PhysicalCampaign, setting: Asked, key: tuple[int, ...]
) -> tuple[SineRun, Errors, float]:
    stream = Stream(*key, _SETUP)
    wanted = Setting(setting.amplitude, setting.frequency, setting.current)
    run, errors = set_up(campaign.bench, wanted, campaign.plan, stream)
    return run, errors, campaign.thermometer_sd * stream.one_normal()


def _what_was_true(
    setting: Asked, prepared: Prepared, k: int, courses: Courses, column: int
) -> dict[str, Any]:
    """Test k of the design, in a column of what happened.

    Digits are few where a number comes out of the solution, so that another machine's rounding
    does not show.
    """
    run, errors, outset = prepared.runs[k], prepared.errors[k], prepared.outset
    return {
        "amplitude": run.amplitude, "frequency": run.frequency, "current": setting.current,
        "centre": run.centre, "harmonics": [[h.order, h.size, h.lead] for h in run.harmonics],
        "gain": errors.gain, "offset": errors.offset, "delay": errors.delay,
        "thermometer": prepared.thermometer[k],
        "yield_stress_40C": round(float(outset.yield_stress[k]), 3),
        "oil_start": round(float(outset.oil[k]), 6),
        "oil_end": round(float(courses.oil[-1, column]), 4),
        "body_start": round(float(outset.body[k]), 6),
        "most_foam": round(float(courses.foam[:, column].max()), 6),
        "least_pressure": round(float(courses.near[:, column].min())),
    }  # fmt: skip
