"""A sound test, the faults that rigs and people put into it, and what the checks say of it."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from sysid.data.campaign import Campaign
from sysid.data.manifest import Manifest
from sysid.data.quality import Fault, QualityReport, inspect
from sysid.data.record import Record, Source
from tests.data.synthetic import make_record


def report_of(*records: Record) -> QualityReport:
    return inspect(Campaign("rig", Path("."), tuple(records), Manifest()))


def faults_of(record: Record) -> dict[str, list[Fault]]:
    (test,) = report_of(record).tests
    kinds: dict[str, list[Fault]] = {}
    for fault in test.faults:
        kinds.setdefault(fault.kind, []).append(fault)
    return kinds


def clean(**changes: object) -> Record:
    """10 mm, 2 Hz, 1000 Hz, 12 cycles, 5 N of noise, ramps and rest."""
    settings: dict[str, object] = {"cycles": 12.3, "noise": 5.0, "ramp": 1.0, "rest": 0.5}
    return make_record(**(settings | changes))  # pyright: ignore[reportArgumentType]


def cycle_of(record: Record) -> np.ndarray:
    """Cycles since the start of the motion, by the construction of `clean`."""
    return (record.time - 0.5) * 2.0


def clipped(record: Record) -> Record:
    return replace(record, force=np.minimum(record.force, 900.0))


def stroke_stop(record: Record) -> Record:
    return replace(record, displacement=np.maximum(record.displacement, -0.0395))


def growing(record: Record) -> Record:
    size = 1.0 + 0.003 * (cycle_of(record) - 7.0)
    return replace(record, displacement=-0.03 + size * (record.displacement + 0.03))


def wandering(record: Record) -> Record:
    return replace(record, displacement=record.displacement + 5e-5 * cycle_of(record))


def fading(record: Record) -> Record:
    return replace(record, force=record.force * (1.0 - 0.01 * cycle_of(record)))


def sinking(record: Record) -> Record:
    return replace(record, force=record.force - 13.0 * cycle_of(record))


def warming(record: Record) -> Record:
    return replace(record, temperature=20.0 + 0.5 * cycle_of(record))


def dropping(record: Record) -> Record:
    force = record.force.copy()
    for cycle in (3.95, 6.0, 6.45):
        hit = (cycle_of(record) > cycle) & (cycle_of(record) < cycle + 0.02)
        force[hit] *= 0.6
    return replace(record, force=force)


def frozen(first: float, last: float) -> Callable[[Record], Record]:
    """The force channel holds what it had at one cycle up to another."""

    def change(record: Record) -> Record:
        held = (cycle_of(record) >= first) & (cycle_of(record) < last)
        return replace(record, force=np.where(held, record.force[held][0], record.force))

    return change


def flipped(record: Record) -> Record:
    return replace(record, force=-record.force)


def labelled(**changes: float) -> Callable[[Record], Record]:
    return lambda record: replace(record, nominal=replace(record.nominal, **changes))


def recorded(spike: float = 20.0, **channels: float) -> Callable[[Record], Record]:
    """Channels at one value, but for a sample that tells nothing of their unit."""

    def change(record: Record) -> Record:
        values = {name: np.full(record.time.size, z) for name, z in channels.items()}
        for channel in values.values():
            channel[7] = spike
        return replace(record, **values)

    return change


def with_velocity(scale: float, delay: float) -> Callable[[Record], Record]:
    def change(record: Record) -> Record:
        velocity = scale * np.gradient(record.displacement, record.time)
        late = np.interp(record.time - delay, record.time, velocity)
        return replace(record, velocity=late)

    return change


def coarse(record: Record) -> Record:
    return replace(record, force=np.round(record.force / 40.0) * 40.0)


def jittered(record: Record) -> Record:
    rng = np.random.default_rng(2)
    return replace(record, time=record.time + rng.uniform(-2e-4, 2e-4, record.time.size))


def gappy(record: Record) -> Record:
    keep = np.ones(record.time.size, dtype=bool)
    keep[3000:3020] = False
    cut = {name: getattr(record, name)[keep] for name in ("time", "displacement", "force")}
    return replace(record, **cut)


def paused(record: Record) -> Record:
    keep = np.ones(record.time.size, dtype=bool)
    keep[record.time.size // 4 : record.time.size // 2] = False
    cut = {name: getattr(record, name)[keep] for name in ("time", "displacement", "force")}
    return replace(record, **cut)


def repaired(record: Record) -> Record:
    changes = ("time stamps repeat in 3 of 1000 rows: the rows that repeat one were left out",)
    return replace(record, source=Source("a.csv", "0", None, changes))


def resting(record: Record) -> Record:
    return replace(record, displacement=np.full(record.time.size, -0.03))


def coarsely_sampled(record: Record) -> Record:
    few = {name: getattr(record, name)[::60] for name in ("time", "displacement", "force")}
    return replace(record, **few)


def slowly_sampled(record: Record) -> Record:
    few = {name: getattr(record, name)[::18] for name in ("time", "displacement", "force")}
    return replace(record, **few)


def humming(size: float, frequency: float = 49.8) -> Callable[[Record], Record]:
    def change(record: Record) -> Record:
        hum = size * np.sin(2.0 * np.pi * frequency * record.time)
        return replace(record, force=record.force + hum)

    return change


def squashed(record: Record) -> Record:
    """Three per cent of third harmonic."""
    x = (record.displacement + 0.03) / 0.01
    third = 3.0 * x - 4.0 * x**3
    return replace(record, displacement=record.displacement + 3e-4 * third)


def shortened(record: Record) -> Record:
    part = slice(2000, 2750)
    few = {name: getattr(record, name)[part] for name in ("time", "displacement", "force")}
    return replace(record, **few)


def hardly_begun(record: Record) -> Record:
    part = slice(2000, 2380)
    few = {name: getattr(record, name)[part] for name in ("time", "displacement", "force")}
    return replace(record, **few)


def unplugged(noise: float, hum: float = 0.0, offset: float = 37.0) -> Callable[[Record], Record]:
    """The force channel without a sensor: an offset, noise, the mains."""

    def change(record: Record) -> Record:
        heard = offset + noise * np.random.default_rng(3).normal(size=record.time.size)
        heard += hum * np.sin(2.0 * np.pi * 50.0 * record.time)
        return replace(record, force=heard)

    return change


def flickering(record: Record) -> Record:
    """A converter without a sensor, whose last bit is now one, now the other."""
    high = np.random.default_rng(3).random(record.time.size) < 0.2
    return replace(record, force=np.where(high, 0.4, 0.0))


def followed_by(cycles: float, frequency: float) -> Callable[[Record], Record]:
    """Another test in the same file, without a pause."""

    def change(record: Record) -> Record:
        still = record.time < 0.5 + 0.5 * 13.3  # of `clean`: rest, a ramp and its cycles
        next_one = clean(cycles=cycles, frequency=frequency, ramp=0.0, rest=0.0, seed=7)
        start = record.time[still][-1] + 1e-3
        return replace(
            record,
            time=np.concatenate([record.time[still], start + next_one.time]),
            displacement=np.concatenate([record.displacement[still], next_one.displacement]),
            force=np.concatenate([record.force[still], next_one.force]),
        )

    return change


def a_day(record: Record) -> Record:
    """Eight tests in one record, each after a rest."""
    tests = [
        clean(cycles=6.0, frequency=f, amplitude=a, seed=k)
        for k, (a, f) in enumerate((a, f) for a in (0.005, 0.01) for f in (0.5, 1.0, 2.0, 3.0))
    ]
    displacement = np.concatenate([test.displacement for test in tests])
    force = np.concatenate([test.force for test in tests])
    time = 1e-3 * np.arange(force.size)
    return replace(record, time=time, displacement=displacement, force=force)


def rectified(record: Record) -> Record:
    return replace(record, force=np.abs(record.force))


def in_milliseconds(record: Record) -> Record:
    """Time in ms, called seconds, and no label that contradicts it."""
    label = replace(record.nominal, frequency=None)
    return replace(record, time=1e3 * record.time, nominal=label)


def in_another_unit(stroke: float = 1.0, force: float = 1.0) -> Callable[[Record], Record]:
    """The same file, its header or manifest with another unit; the label likewise."""

    def change(record: Record) -> Record:
        amplitude = record.nominal.amplitude
        label = replace(record.nominal, amplitude=None if amplitude is None else stroke * amplitude)
        return replace(
            record, displacement=stroke * record.displacement, force=force * record.force,
            nominal=label,
        )  # fmt: skip

    return change
