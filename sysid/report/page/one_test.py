"""One test as the page shows it: measured, simulated by every model, and read off."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from jaxtyping import Float

from sysid.data.descriptors import Descriptors, describe
from sysid.data.loops import Loops
from sysid.data.record import Record
from sysid.motion.motion import Motion

Role = Literal["fitted", "held out", "compared", "left out"]
NAN: Final = float("nan")

LOOP_POINTS: Final = 180
"""Phase points of a loop that the page keeps: 2° apart, so that a knee keeps its corner."""
HISTORY_POINTS: Final = 6000
"""Samples of a record that is not sinusoidal that the page keeps."""
HISTORY_RATE: Final = 200.0
"""Hz; samples are left out of such a record down to this rate only, else its peaks are lost."""

Force = Float[np.ndarray, "loop phase"]


@dataclass(frozen=True)
class Traces:
    """What the figures of one test are drawn from.

    Attributes:
        over: "phase" in degrees for a loop, "time" in s for any other motion.
        along: [n] phase or time.
        displacement: [n] m.
        velocity: [n] m/s.
        force: [n] N, measured.
        models: One [n] N a model.
        part: Which part of a longer record is shown, in words; empty if all of it.
    """

    over: Literal["phase", "time"]
    along: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    force: np.ndarray
    models: tuple[np.ndarray, ...]
    part: str = ""


@dataclass(frozen=True)
class ReadOff:
    """What damper people read off a loop; the gas force is taken off both peaks.

    Attributes:
        compression: Largest force, N.
        rebound: Largest force the other way, N.
        gas: Mean of the forces at both reversals, N.
        gamma: rebound / compression.
        knee: Transition velocity, m/s.
        friction: Half the loop's height at rest, N.
        energy: Of a cycle, J.
        stiffness: Of the fundamental, N/m.
        damping: Equivalent, N·s/m.
    """

    compression: float
    rebound: float
    gas: float
    gamma: float
    knee: float
    friction: float
    energy: float
    stiffness: float
    damping: float


@dataclass(frozen=True)
class OneTest:
    """A test of the campaign.

    Attributes:
        id: Of the record.
        role: What it was used for.
        why: Why it was left out.
        kind: Of its motion.
        amplitude: m; NaN where there is none, as below.
        frequency: Hz.
        current: A.
        temperature: °C.
        errors: RMSE/max|F|, one a model.
        rmse: N, one a model.
        peak: max|F|, N.
        noise: Standard deviation from cycle to cycle, N.
        cycles: That were averaged.
        measured: What is read off the measured loop.
        simulated: The same of the last model's loop.
        traces: None for a test that was left out.
    """

    id: str
    role: Role
    why: str | None = None
    kind: str = "sine"
    amplitude: float = NAN
    frequency: float = NAN
    current: float = NAN
    temperature: float = NAN
    errors: tuple[float, ...] = ()
    rmse: tuple[float, ...] = ()
    peak: float = NAN
    noise: float = NAN
    cycles: int = 0
    measured: ReadOff | None = None
    simulated: ReadOff | None = None
    traces: Traces | None = None

    @property
    def peak_velocity(self) -> float:
        """Aω, m/s."""
        return 2.0 * np.pi * self.frequency * self.amplitude

    @property
    def mean_cycle_noise(self) -> float:
        """`noise` over √`cycles`, N; NaN where it is not known."""
        return float(self.noise / np.sqrt(self.cycles)) if self.cycles else NAN


def loop_tests(
    loops: Loops,
    forces: Sequence[Force],
    errors: Mapping[str, Sequence[float]],
    roles: Mapping[str, Role],
) -> tuple[OneTest, ...]:
    """Sinusoidal tests.

    Args:
        loops: L tests.
        forces: [L, J] N of each model, simulated.
        errors: Id → RMSE/max|F| of each model, as the result states them.
        roles: Id → role.
    """
    if not loops.ids:
        return ()
    measured = _read(loops)
    simulated = _read(replace(loops, force=forces[-1])) if forces else (None,) * len(loops.ids)
    step = max(1, loops.force.shape[1] // LOOP_POINTS)
    degrees = 360.0 * np.arange(loops.force.shape[1])[::step] / loops.force.shape[1]
    found = []
    for k, name in enumerate(loops.ids):
        force = loops.force[k]
        traces = Traces(
            "phase", degrees, loops.displacement[k, ::step], loops.velocity[k, ::step],
            force[::step], tuple(f[k, ::step] for f in forces),
        )  # fmt: skip
        found.append(
            OneTest(
                id=name, role=roles[name], amplitude=float(loops.amplitude[k]),
                frequency=float(loops.frequency[k]), current=float(loops.current[k]),
                temperature=float(loops.temperature[k]),
                errors=tuple(float(e) for e in errors[name]),
                rmse=tuple(_rms(f[k] - force) for f in forces),
                peak=float(np.abs(force).max()), noise=float(loops.noise_floor[k]),
                cycles=int(loops.cycles[k]), measured=measured[k], simulated=simulated[k],
                traces=traces,
            )
        )  # fmt: skip
    return tuple(found)


def history_test(
    record: Record,
    motion: Motion,
    forces: Sequence[np.ndarray],
    errors: Sequence[float],
    role: Role,
) -> OneTest:
    """A test that is not sinusoidal, over its own time.

    Of a long record the page shows the part about the last model's largest error.

    Args:
        record: The test.
        motion: Its motion.
        forces: [n] N of each model.
        errors: RMSE/max|F| of each model.
        role: What it was used for.
    """
    shown, part = _shown(record, forces[-1] - record.force if forces else record.force)
    traces = Traces(
        "time", record.time[shown], np.asarray(motion.displacement)[shown],
        np.asarray(motion.velocity)[shown], record.force[shown],
        tuple(np.asarray(f)[shown] for f in forces), part,
    )  # fmt: skip
    told = record.nominal
    return OneTest(
        id=record.id, role=role, kind=told.kind, amplitude=_or_nan(told.amplitude),
        frequency=_or_nan(told.frequency), current=_or_nan(told.current),
        temperature=_or_nan(told.temperature), errors=tuple(float(e) for e in errors),
        rmse=tuple(_rms(np.asarray(f) - record.force) for f in forces),
        peak=float(np.abs(record.force).max()), traces=traces,
    )  # fmt: skip


def _shown(record: Record, error: np.ndarray) -> tuple[slice, str]:
    """Samples of a record that the page keeps, and which part of it that is, in words."""
    t = record.time
    rate = (t.size - 1) / (t[-1] - t[0])
    step = max(1, min(int(rate / HISTORY_RATE), -(-t.size // HISTORY_POINTS)))
    if t.size <= step * HISTORY_POINTS:
        return slice(None, None, step), ""
    length = step * HISTORY_POINTS
    worst = int(np.argmax(np.where(np.isfinite(error), np.abs(error), 0.0)))
    first = int(np.clip(worst - length // 2, 0, t.size - length))
    last = first + length - 1
    told = f"{t[first]:.4g} to {t[last]:.4g} s of {t[0]:.4g} to {t[-1]:.4g} s"
    return slice(first, last + 1, step), f"{told}, about the largest error"


def absent_tests(left_out: Mapping[str, str], records: Sequence[Record]) -> tuple[OneTest, ...]:
    """Tests that were not used, with the reason.

    Args:
        left_out: Id → reason.
        records: Of the campaign, for what the tests were meant to be.
    """
    told = {record.id: record.nominal for record in records}
    found = []
    for name, why in left_out.items():
        test = OneTest(id=name, role="left out", why=why)
        if name in told:
            n = told[name]
            test = replace(
                test, kind=n.kind, amplitude=_or_nan(n.amplitude), frequency=_or_nan(n.frequency),
                current=_or_nan(n.current), temperature=_or_nan(n.temperature),
            )  # fmt: skip
        found.append(test)
    return tuple(found)


def worst_of(tests: Sequence[OneTest]) -> int | None:
    """Place of the test with the largest error of the first model; None without any."""
    known = [k for k, t in enumerate(tests) if t.errors and t.traces and np.isfinite(t.errors[0])]
    return max(known, key=lambda k: tests[k].errors[0]) if known else None


def _read(loops: Loops) -> list[ReadOff | None]:
    """Nothing where a model has no force, since the current is not known."""
    sound = np.asarray(np.isfinite(loops.force).all(axis=1))
    found: list[ReadOff | None] = [None] * len(loops.ids)
    if sound.any():
        read = describe(loops.select(sound))
        for place, k in enumerate(np.flatnonzero(sound)):
            found[k] = _read_off(read, place)
    return found


def _read_off(d: Descriptors, k: int) -> ReadOff:
    gas = float(d.reversal_force[k])
    off = gas if np.isfinite(gas) else 0.0
    compression, rebound = float(d.peak_compression[k]) - off, float(d.peak_rebound[k]) + off
    return ReadOff(
        compression=compression,
        rebound=rebound,
        gas=gas,
        gamma=rebound / compression if compression > 0.0 else NAN,
        knee=float(d.knee_velocity[k]),
        friction=0.5 * float(d.force_width[k]),
        energy=float(d.energy[k]),
        stiffness=float(d.effective_stiffness[k]),
        damping=float(d.equivalent_damping[k]),
    )


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def _or_nan(value: float | None) -> float:
    return NAN if value is None else float(value)
