"""The test bench: what its actuator, load cell and recorder make of a damper's force."""

import math
from dataclasses import dataclass
from typing import Any, Final, Protocol

import numpy as np
from jaxtyping import Float

from sysid.errors import DataError
from sysid.rig.chance import Stream
from sysid.rig.damper import HystereticDamper
from sysid.rig.elementary import sine
from sysid.rig.excitation import Harmonic, SineRun
from sysid.rig.recording import Recording, digitise

Samples = Float[np.ndarray, " n"]


@dataclass(frozen=True)
class Setting:
    """What the operator asks for.

    Attributes:
        amplitude: m.
        frequency: Hz.
        current: A.
        triangular: Constant speed between rounded corners instead of a sine wave.
    """

    amplitude: float
    frequency: float
    current: float
    triangular: bool = False


@dataclass(frozen=True)
class Plan:
    """How a test goes on: s of rest at either end, cycles of the ramps and of steady motion."""

    rest: float
    ramp_up: float
    steady: float
    ramp_down: float


@dataclass(frozen=True)
class Bench:
    """How large the imperfections are; each `_sd` is the standard deviation over tests.

    Attributes:
        amplitude_sd: Relative error of the stroke reached.
        frequency_sd: Relative error of the frequency.
        centre: Mean displacement of all tests, m.
        centre_sd: m.
        second_harmonic: Of the actuator, relative to the fundamental.
        third_harmonic: The same.
        gain_sd: Relative error of the load cell's gain.
        offset_sd: Of the load cell's zero, N.
        delay_sd: Of the force channel against the displacement channel, s.
        force_noise: Per sample, relative to the RMS force of the test's steady cycles.
        displacement_noise: Per sample, m.
        current_noise: Of the recorded current, A.
        temperature: °C.
        temperature_sd: K.
        heating: Rise over a test, K.
        temperature_noise: Per sample, K.
    """

    amplitude_sd: float = 4e-3
    frequency_sd: float = 5e-4
    centre: float = 3.2e-3
    centre_sd: float = 2e-4
    second_harmonic: float = 1.5e-3
    third_harmonic: float = 3e-3
    gain_sd: float = 6e-3
    offset_sd: float = 2.0
    delay_sd: float = 1e-4
    force_noise: float = 0.01
    displacement_noise: float = 3e-6
    current_noise: float = 3e-4
    temperature: float = 40.0
    temperature_sd: float = 1.5
    heating: float = 0.3
    temperature_noise: float = 0.05


@dataclass(frozen=True)
class Errors:
    """True errors of one test's force channel, and what its temperature does.

    Attributes:
        gain: Recorded force is (1 + gain) times the true one.
        offset: N, added.
        delay: s, by which the recorded force is late.
        noise: Standard deviation per sample, N.
        temperature: At the start, °C.
    """

    gain: float
    offset: float
    delay: float
    noise: float
    temperature: float


SAMPLING: Final[tuple[tuple[float, int], ...]] = (
    (1.0, 200),
    (4.0, 500),
    (6.0, 1000),
    (math.inf, 2000),
)
"""Highest frequency (Hz) → sampling rate (Hz): 133 to 400 samples a cycle."""

REST: Final = 0.15
RAMP_UP, STEADY, RAMP_DOWN = 1.5, 8.0, 1.0
"""Seconds of rest at either end; cycles of the ramps and of steady motion."""
PLAN: Final = Plan(REST, RAMP_UP, STEADY, RAMP_DOWN)

_SETUP, _FORCE, _DISPLACEMENT, _CURRENT, _TEMPERATURE = range(5)
"""Streams of random numbers of one test."""


class Drive(Protocol):
    """What stands between the current asked for and the current in the coil."""

    def current(self, run: SineRun, first: float, count: int, rate: int, command: float) -> Samples:
        """Current in the coil, [count] A.

        Args:
            run: Motion of the piston.
            first: Time of the first sample, s.
            count: Samples.
            rate: Of the samples, Hz.
            command: Current asked for, A.
        """
        ...


def run_test(
    damper: HystereticDamper,
    bench: Bench,
    setting: Setting,
    key: tuple[int, ...],
    drive: Drive | None = None,
) -> tuple[Recording, SineRun, Errors]:
    """Run one test.

    Args:
        damper: In the bench.
        bench: Its imperfections.
        setting: What is asked for.
        key: Seed of the campaign and number of the test: names its random numbers.
        drive: Of the coil, whose current is not recorded; None for the current asked for.

    Returns:
        What is recorded, the true motion and the true errors.
    """
    run, errors = set_up(bench, setting, PLAN, Stream(*key, _SETUP))
    rate = next(r for highest, r in SAMPLING if setting.frequency <= highest)
    count = int(run.duration * rate) + 1
    time = np.arange(count) / rate
    coil: float | Samples = setting.current
    if drive is not None:
        # the force channel is late: what it records now the damper did a moment ago
        coil = drive.current(run, -errors.delay, count, rate, setting.current)
    true = damper.force(run.state(time - errors.delay), coil)
    channel = (1.0 + errors.gain) * true + errors.offset
    steady = channel[run.steady_part(time)]
    noise = bench.force_noise * math.sqrt(math.fsum(steady * steady) / steady.size)
    errors = Errors(errors.gain, errors.offset, errors.delay, noise, errors.temperature)
    force = channel + noise * Stream(*key, _FORCE).normal(count)
    jitter = bench.displacement_noise * Stream(*key, _DISPLACEMENT).normal(count)
    current = setting.current + bench.current_noise * Stream(*key, _CURRENT).normal(count)
    recording = Recording(
        rate=rate,
        displacement=digitise(1e6 * (run.state(time).displacement + jitter)),
        force=digitise(10.0 * force),
        current=digitise(1e3 * current),
        temperature=digitise(
            10.0 * _temperature(bench, errors, time / run.duration, Stream(*key, _TEMPERATURE))
        ),
    )
    return recording, run, errors


def set_up(bench: Bench, setting: Setting, plan: Plan, stream: Stream) -> tuple[SineRun, Errors]:
    """Draw the errors of one test; the order of the draws is part of the data.

    Args:
        bench: Sizes of the errors.
        setting: What is asked for.
        plan: Rest, ramps, cycles.
        stream: Of random numbers.

    Returns:
        The true motion, and the true errors but for the noise, which depends on the force.

    Raises:
        DataError: A triangle wave is asked for.
    """
    if setting.triangular:
        raise DataError(
            "raw records of triangle waves are not simulated",
            advice="Trial campaigns have them, as steady cycles",
        )
    run = SineRun(
        amplitude=setting.amplitude * (1.0 + bench.amplitude_sd * stream.one_normal()),
        frequency=setting.frequency * (1.0 + bench.frequency_sd * stream.one_normal()),
        centre=bench.centre + bench.centre_sd * stream.one_normal(),
        harmonics=(
            Harmonic(2, bench.second_harmonic, stream.one_uniform()),
            Harmonic(3, bench.third_harmonic, stream.one_uniform()),
        ),
        rest=plan.rest,
        ramp_up=plan.ramp_up,
        steady=plan.steady,
        ramp_down=plan.ramp_down,
    )
    errors = Errors(
        gain=bench.gain_sd * stream.one_normal(),
        offset=bench.offset_sd * stream.one_normal(),
        delay=bench.delay_sd * stream.one_normal(),
        noise=0.0,
        temperature=bench.temperature + bench.temperature_sd * stream.one_normal(),
    )
    return run, errors


def _temperature(bench: Bench, errors: Errors, share: Samples, stream: Stream) -> Samples:
    """A slow rise with a wave on it, °C, and the thermocouple's noise."""
    wave = sine(share + stream.one_uniform())
    noise = bench.temperature_noise * stream.normal(share.size)
    return errors.temperature + bench.heating * (share + 0.3 * wave) + noise


def what_was_true(run: SineRun, errors: Errors, current: float) -> dict[str, Any]:
    """What a seal keeps of one test, SI.

    Args:
        run: Its motion.
        errors: Of its force channel.
        current: A, as asked for.
    """
    return {
        "amplitude": run.amplitude,
        "frequency": run.frequency,
        "current": current,
        "centre": run.centre,
        "harmonics": [[h.order, h.size, h.lead] for h in run.harmonics],
        "gain": errors.gain,
        "offset": errors.offset,
        "delay": errors.delay,
        "noise": errors.noise,
        "temperature": errors.temperature,
    }
