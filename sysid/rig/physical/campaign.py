"""A campaign on the physical damper: settings, protocol, run order, all tests, files."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import equinox as eqx
import jax
import numpy as np

from sysid.rig.bench import Bench, Errors, Plan, Setting, set_up
from sysid.rig.chance import Stream
from sysid.rig.excitation import SineRun
from sysid.rig.physical.channels import Channels, record
from sysid.rig.physical.course import POINTS, Courses, Outset, run_tests
from sysid.rig.physical.damper import PhysicalDamper
from sysid.rig.physical.magnet import after_history, field_yield_stress
from sysid.rig.physical.mechanisms import at_levels
from sysid.rig.physical.warming import Operator
from sysid.rig.recording import Recording

_ORDER, _OPERATOR, _SETUP = 1_000_000, 1_000_001, 0
"""Name random numbers: of the run order, of the operator, of one test's set-up."""
PLAN: Final = Plan(rest=0.15, ramp_up=1.5, steady=4.0, ramp_down=1.0)


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
        """Sampling rate, Hz: 133 to 200 a cycle, so that times have at most four decimals."""
        return next(rate for highest, rate in SAMPLING if self.frequency <= highest)


SAMPLING: Final[tuple[tuple[float, int], ...]] = (
    (0.1, 20), (0.5, 100), (1.5, 250), (2.5, 500), (5.0, 1000), (8.0, 1250), (12.5, 2000),
    (math.inf, 2500),
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
    points: int = POINTS


@dataclass(frozen=True)
class TestsRun:
    """A campaign that was run.

    Attributes:
        recordings: In the order of the design.
        truths: What was true of each test, SI and °C.
        positions: Place of each test in the run order, from 1.
        courses: What happened.
        runs: The commands.
    """

    recordings: tuple[Recording, ...]
    truths: tuple[dict[str, Any], ...]
    positions: tuple[int, ...]
    courses: Courses
    runs: tuple[SineRun, ...]


def run_campaign(campaign: PhysicalCampaign, key: int) -> TestsRun:
    """Run all tests: the history of the damper first, then all at once.

    What a test inherits from those before it is worked out in advance: the way its seal has slid
    and the currents its iron has seen, exactly; its temperature from the operator's protocol.
    """
    damper = at_levels(campaign.damper, campaign.levels)
    settings, channels = campaign.settings, campaign.channels
    order = _order(settings, key)
    drawn = [_draw(campaign, setting, (key, k)) for k, setting in enumerate(settings)]
    runs = tuple(run for run, _, _ in drawn)
    oil, body = _temperatures(campaign, damper, order, Stream(key, _OPERATOR))
    stress = _yield_stresses(damper, settings, order)
    current = np.array([setting.current for setting in settings])
    outset = Outset(stress, current**2 * damper.magnet.resistance, oil, body)
    worn = _worn(damper, _ways(runs, order))
    courses = run_tests(worn, runs, outset, campaign.points)
    recordings, truths = [], []
    for k, (setting, (run, errors, thermometer)) in enumerate(zip(settings, drawn, strict=True)):
        recordings.append(
            record(
                channels,
                courses,
                k,
                run,
                setting.rate,
                setting.current,
                float(damper.heat.thermocouple),
                errors,
                thermometer,
                (key, k),
            )
        )
        truths.append(_what_was_true(courses, k, run, errors, thermometer, setting, stress[k]))
    positions = [0] * len(settings)
    for place, k in enumerate(order, start=1):
        positions[k] = place
    return TestsRun(tuple(recordings), tuple(truths), tuple(positions), courses, runs)


def _order(settings: tuple[Asked, ...], key: int) -> list[int]:
    rank = Stream(key, _ORDER).order(len(settings)).tolist()
    return sorted(range(len(settings)), key=lambda k: (settings[k].temperature, rank[k]))


def _draw(
    campaign: PhysicalCampaign, setting: Asked, key: tuple[int, ...]
) -> tuple[SineRun, Errors, float]:
    stream = Stream(*key, _SETUP)
    wanted = Setting(setting.amplitude, setting.frequency, setting.current)
    run, errors = set_up(campaign.bench, wanted, PLAN, stream)
    return run, errors, campaign.thermometer_sd * stream.one_normal()


def _temperatures(
    campaign: PhysicalCampaign, damper: PhysicalDamper, order: list[int], stream: Stream
) -> tuple[np.ndarray, np.ndarray]:
    """Oil and body at the start of each test, °C, in the order of the design."""
    operator, room = campaign.operator, float(damper.heat.room)
    oils, bodies = np.empty(len(order)), np.empty(len(order))
    oil, body = room, room
    for k in order:
        wanted = campaign.settings[k].temperature
        away = operator.scatter * stream.one_normal()
        target = wanted + max(-operator.window, min(operator.window, away))
        oil, body = operator.bring(damper.heat, oil, body, target)
        oils[k], bodies[k] = oil, body
    return oils, bodies


def _yield_stresses(
    damper: PhysicalDamper, settings: tuple[Asked, ...], order: list[int]
) -> np.ndarray:
    """Of each test at 40 °C, Pa: the iron remembers the two tests before; between, 0 A."""
    current = np.array([settings[k].current for k in order])
    before = np.concatenate([[0.0, 0.0], current])
    none = np.zeros_like(current)
    ways = np.stack([before[:-2], none, before[1:-1], none, current])
    gap, solids = float(damper.valve.gap), float(damper.oil.solids)
    stress = np.empty_like(current)
    stress[order] = field_yield_stress(after_history(damper.magnet, gap, solids, ways), solids)
    return stress


def _ways(runs: tuple[SineRun, ...], order: list[int]) -> np.ndarray:
    """M that the seal has slid before each test."""
    own = np.array([4.0 * r.amplitude * (r.steady + 0.5 * (r.ramp_up + r.ramp_down)) for r in runs])
    ways = np.empty(len(runs))
    ways[order] = np.cumsum(own[order]) - own[order]
    return ways


def _worn(damper: PhysicalDamper, ways: np.ndarray) -> PhysicalDamper:
    """The damper of each test: constants that wear changes have one value for each."""
    count = len(ways)
    each = jax.tree.map(lambda leaf: np.full(count, float(leaf)), damper)
    wear = damper.wear
    seal, gas = np.exp(-float(wear.seal) * ways), np.exp(-float(wear.gas) * ways)
    creep = np.exp(float(wear.creep) * ways)
    return _scaled(each, {("seal", "sliding"): seal, ("seal", "breakaway"): seal,
                          ("gas", "charge"): gas, ("valve", "creep"): creep})  # fmt: skip


def _scaled(
    damper: PhysicalDamper, factors: Mapping[tuple[str, str], np.ndarray]
) -> PhysicalDamper:
    for (part, name), factor in factors.items():
        value = getattr(getattr(damper, part), name) * factor
        damper = eqx.tree_at(lambda d, p=part, n=name: getattr(getattr(d, p), n), damper, value)
    return damper


def _what_was_true(
    courses: Courses, k: int, run: SineRun, errors: Errors, thermometer: float, setting: Asked,
    stress: float,
) -> dict[str, Any]:  # fmt: skip
    return {
        "amplitude": run.amplitude, "frequency": run.frequency, "current": setting.current,
        "centre": run.centre, "harmonics": [[h.order, h.size, h.lead] for h in run.harmonics],
        "gain": errors.gain, "offset": errors.offset, "delay": errors.delay,
        "thermometer": thermometer, "yield_stress_40C": round(float(stress), 3),
        "oil_start": round(float(courses.oil[0, k]), 6),
        "oil_end": round(float(courses.oil[-1, k]), 6),
        "body_start": round(float(courses.body[0, k]), 6),
        "most_foam": round(float(courses.foam[:, k].max()), 9),
        "least_pressure": round(float(courses.near[:, k].min()), 1),
    }  # fmt: skip
