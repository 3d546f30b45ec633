"""One test of a warm damper on the bench: true course, errors, recording."""

import math
from dataclasses import dataclass

import numpy as np

from sysid.rig.bench import Errors, Setting, set_up
from sysid.rig.chance import Stream
from sysid.rig.excitation import SineRun
from sysid.rig.lumped_run import Course, run_damper
from sysid.rig.recording import Recording, digitise
from sysid.rig.sweep import Sweep, WarmSetting

_SETUP, _FORCE, _DISPLACEMENT, _CURRENT, _TEMPERATURE = range(5)
"""Streams of random numbers of one test."""


@dataclass(frozen=True)
class WarmTest:
    """A test that was run.

    Attributes:
        recording: What the recorder stored.
        run: The true motion.
        errors: The true errors; the temperature is that of the oil at the start, °C.
        thermometer: Error of the thermometer, K.
        course: What the damper did.
    """

    recording: Recording
    run: SineRun
    errors: Errors
    thermometer: float
    course: Course


def run_warm_test(
    sweep: Sweep, setting: WarmSetting, temperature: float, key: tuple[int, ...]
) -> WarmTest:
    """Run one test.

    Args:
        sweep: Damper, heat balance and imperfections.
        setting: What is asked for.
        temperature: Of the oil at the start, °C.
        key: Seed of the campaign and number of the test: names its random numbers.
    """
    bench, rate = sweep.bench, setting.rate
    wanted = Setting(setting.amplitude, setting.frequency, setting.current)
    stream = Stream(*key, _SETUP)
    run, errors = set_up(bench, wanted, setting.plan, stream)
    thermometer = sweep.thermometer_sd * stream.one_normal()
    time = np.arange(int(run.duration * rate) + 1) / rate
    # the force channel is late: what it records now the damper did a moment ago
    course = run_damper(
        sweep.damper,
        sweep.heat,
        lambda at: run.state(at).velocity,
        time - errors.delay,
        setting.current,
        run.frequency,
        temperature,
    )
    count, channel = time.size, (1.0 + errors.gain) * course.force + errors.offset
    steady = channel[run.steady_part(time)]
    noise = bench.force_noise * math.sqrt(math.fsum(steady * steady) / steady.size)
    force = channel + noise * Stream(*key, _FORCE).normal(count)
    jitter = bench.displacement_noise * Stream(*key, _DISPLACEMENT).normal(count)
    current = setting.current + bench.current_noise * Stream(*key, _CURRENT).normal(count)
    felt = course.thermometer + bench.temperature_noise * Stream(*key, _TEMPERATURE).normal(count)
    recording = Recording(
        rate=rate,
        displacement=digitise(1e6 * (run.state(time).displacement + jitter)),
        force=digitise(10.0 * force),
        current=digitise(1e3 * current),
        temperature=digitise(10.0 * (felt + thermometer)),
    )
    errors = Errors(errors.gain, errors.offset, errors.delay, noise, temperature)
    return WarmTest(recording, run, errors, thermometer, course)
