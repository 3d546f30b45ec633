"""From records to loops: steady cycles cut on the displacement's phase, stacked on one grid."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from sysid.data.figures import current_figures
from sysid.data.harmonics import ORDER, evaluate, fit_harmonics, highest_order, significant
from sysid.data.loops import Loops
from sysid.data.other_motions import CURE
from sysid.data.phase_grid import phase_average
from sysid.data.record import Record
from sysid.data.steady import NoSteadyPartError, Steady, find_steady
from sysid.errors import DataError

__all__ = ["LoopSet", "NoSteadyPartError", "Steady", "cut_loop", "cut_loops", "find_steady"]

CONSTANT_CURRENT = 0.05
"""A recorded current that changes by more than this (A), and by a fifth of its mean, is no
constant current."""
STEPPED = "from cycle to cycle"
"""How a current changes that is set anew between cycles, and not within them."""
CURRENT_PARTS = 16
"""Parts of a cycle whose currents are held against each other."""


@dataclass(frozen=True)
class LoopSet:
    """Loops, and the tests that gave none.

    Attributes:
        loops: Stacked loops, in the order of the records.
        left_out: Id of each test without a loop → the reason, one sentence.
        steady: The steady part of each loop, in the order of `loops.ids`.
    """

    loops: Loops
    left_out: dict[str, str]
    steady: tuple[Steady, ...]


@dataclass(frozen=True)
class Loop:
    """One test's row of `Loops`; fields as there, without the leading axis.

    Attributes:
        id: Of the record.
        displacement: [J] m, relative to the centre.
        velocity: [J] m/s.
        acceleration: [J] m/s².
        force: [J] N, cycle mean.
        amplitude: m, of the fundamental.
        frequency: Hz.
        current: A; NaN where unknown.
        temperature: °C; NaN where unknown.
        centre: m.
        cycles: Number of steady cycles averaged.
        noise_floor: N.
        deviations: [cycles, J] N.
        displacement_deviations: [cycles, J] m.
        harmonics: [15] m, complex.
        start_phase: rad.
    """

    id: str
    displacement: Float[np.ndarray, " phase"]
    velocity: Float[np.ndarray, " phase"]
    acceleration: Float[np.ndarray, " phase"]
    force: Float[np.ndarray, " phase"]
    amplitude: float
    frequency: float
    current: float
    temperature: float
    centre: float
    cycles: int
    noise_floor: float
    deviations: Float[np.ndarray, "cycle phase"]
    displacement_deviations: Float[np.ndarray, "cycle phase"]
    harmonics: np.ndarray
    start_phase: float


def cut_loops(records: Iterable[Record], points: int = 360) -> LoopSet:
    """Cut the steady cycles of many records and stack them.

    Args:
        records: Tests; only those of kind ``sine`` give loops.
        points: J, phase points of a loop.

    Raises:
        DataError: Two records share an id, or `points` is too small for the harmonics.
    """
    if points < 4 * ORDER:
        raise DataError(f"{points} points a loop cannot hold {ORDER} harmonics")
    rows: list[Loop] = []
    steadies: list[Steady] = []
    left_out: dict[str, str] = {}
    for record in records:
        if record.id in left_out or any(row.id == record.id for row in rows):
            raise DataError("two tests have the same id", where=record.id)
        if record.nominal.kind != "sine":
            left_out[record.id] = f"declared as {record.nominal.kind}, not as sine"
            continue
        try:
            steady = find_steady(record)
            _refuse_changing_current(record, steady)
        except NoSteadyPartError as error:
            left_out[record.id] = error.what
            continue
        rows.append(cut_loop(record, steady, points))
        steadies.append(steady)
    return LoopSet(_stack(rows, points), left_out, tuple(steadies))


def cut_loop(record: Record, steady: Steady, points: int = 360) -> Loop:
    """Cut one record's steady part into cycles, average them and keep what each departs.

    Force: bin means of every cycle (see `phase_grid`), their mean, and the deviations from it.
    Drift between cycles is not removed.  Displacement: harmonics 1 … 15 of all samples of the
    whole cycles at once, those within noise set to zero; velocity and acceleration are their
    exact derivatives.
    """
    part = slice(steady.start, steady.stop)
    phase, cycles = steady.phase, steady.cycles
    first = int(np.ceil(phase[0] * points / (2.0 * np.pi) - 1e-6))
    whole = phase < phase[0] + 2.0 * np.pi * cycles - 1e-9
    force = phase_average(phase, record.force[part], first, cycles, points)
    x = record.displacement[part] - steady.centre
    path = phase_average(phase, x, first, cycles, points)
    harmonics, centre = _displacement(phase[whole], x[whole], path, steady)
    grid = 2.0 * np.pi * np.arange(points) / points
    omega = 2.0 * np.pi * steady.frequency
    return Loop(
        id=record.id,
        displacement=evaluate(harmonics, grid),
        velocity=evaluate(harmonics, grid, derivative=1, omega=omega),
        acceleration=evaluate(harmonics, grid, derivative=2, omega=omega),
        force=force.mean(axis=0),
        amplitude=float(np.abs(harmonics[0])),
        frequency=steady.frequency,
        current=_mean_or(record.current, part, record.nominal.current),
        temperature=_mean_or(record.temperature, part, record.nominal.temperature),
        centre=steady.centre + centre,
        cycles=cycles,
        noise_floor=noise_floor(force),
        deviations=force - force.mean(axis=0),
        displacement_deviations=path - path.mean(axis=0),
        harmonics=harmonics,
        start_phase=float(2.0 * np.pi * (first % points) / points),
    )


def noise_floor(cycles: Float[np.ndarray, "cycle phase"]) -> float:
    """RMS over phase of the standard deviation (C − 1) between cycles; NaN with one cycle."""
    if cycles.shape[0] < 2:
        return float("nan")
    return float(np.sqrt(np.mean(np.var(cycles, axis=0, ddof=1))))


def _displacement(
    phase: Float[np.ndarray, " n"],
    x: Float[np.ndarray, " n"],
    path: Float[np.ndarray, "cycle phase"],
    steady: Steady,
) -> tuple[np.ndarray, float]:
    """Harmonics above noise, padded with zeros to `ORDER`, and the mean left in x.

    The noise variance of a harmonic of the mean is the larger of what white residuals give and
    what the scatter of the harmonic between cycles gives.
    """
    order = highest_order(steady.samples_per_cycle)
    fit = fit_harmonics(phase, x, order)
    white = 4.0 * float(np.mean(fit.residual**2)) / max(x.size - 2 * order - 1, 1)
    variance = np.full(order, white)
    cycles, points = path.shape
    if cycles > 1:
        each = 2j * np.fft.rfft(path, axis=1)[:, 1 : order + 1] / points
        scatter = np.sum(np.abs(each - each.mean(axis=0)) ** 2, axis=0) / (cycles * (cycles - 1))
        variance = np.maximum(variance, scatter)
    kept = significant(fit.harmonics, variance)
    kept[0] = np.abs(kept[0])
    return np.concatenate([kept, np.zeros(ORDER - order)]), fit.mean


def _refuse_changing_current(record: Record, steady: Steady) -> None:
    """A loop belongs to one current."""
    if record.current is None:
        return
    current = record.current[steady.start : steady.stop]
    sixteenth = np.floor(steady.phase * CURRENT_PARTS / (2.0 * np.pi)).astype(np.int64)
    seen, how = max(
        (_medians(current, sixteenth % CURRENT_PARTS), "within each cycle"),
        (_medians(current, steady.sample_cycle), STEPPED),
        key=lambda one: float(np.ptp(one[0])),
    )
    if np.ptp(seen) > max(CONSTANT_CURRENT, 0.2 * abs(float(np.mean(seen)))):
        unit, (low, high) = current_figures((float(seen.min()), float(seen.max())))
        text = f"the current changes between {low} and {high} {unit} {how}"
        if how == STEPPED:
            text += f"; if these are tests at several currents, {CURE}"
        raise NoSteadyPartError("current_changes", text, where=record.id)


def _medians(
    values: Float[np.ndarray, " n"], group: Int[np.ndarray, " n"]
) -> Float[np.ndarray, " group"]:
    """Median of the values of each group, those numbered below zero left out.

    Spikes and noise of single samples are no change of the current.
    """
    known = np.flatnonzero(group >= 0)
    order = known[np.argsort(group[known], kind="stable")]
    ends = np.flatnonzero(np.diff(group[order])) + 1
    return np.array([np.median(part) for part in np.split(values[order], ends)])


def _mean_or(channel: Float[np.ndarray, " n"] | None, part: slice, label: float | None) -> float:
    """Mean of a recorded channel over the steady part, else the label, else NaN."""
    if channel is not None and np.any(np.isfinite(channel[part])):
        return float(np.nanmean(channel[part]))
    return float("nan") if label is None else float(label)


def _stack(rows: list[Loop], points: int) -> Loops:
    """Stack rows; without rows every array is empty but has its shape."""

    def matrix(name: str) -> np.ndarray:
        values = [getattr(row, name) for row in rows]
        return np.stack(values) if values else np.zeros((0, points))

    def vector(name: str) -> np.ndarray:
        return np.array([getattr(row, name) for row in rows], dtype=np.float64)

    return Loops(
        ids=tuple(row.id for row in rows),
        displacement=matrix("displacement"),
        velocity=matrix("velocity"),
        acceleration=matrix("acceleration"),
        force=matrix("force"),
        amplitude=vector("amplitude"),
        frequency=vector("frequency"),
        current=vector("current"),
        temperature=vector("temperature"),
        centre=vector("centre"),
        cycles=np.array([row.cycles for row in rows], dtype=np.int64),
        noise_floor=vector("noise_floor"),
        deviations=tuple(row.deviations for row in rows),
        displacement_deviations=tuple(row.displacement_deviations for row in rows),
        harmonics=np.stack([row.harmonics for row in rows])
        if rows
        else np.zeros((0, ORDER), dtype=np.complex128),
        start_phase=vector("start_phase"),
    )
