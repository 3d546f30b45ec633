"""The steady sinusoidal part of a record, found from the measured displacement alone."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float, Int

from sysid.data.frequency_guess import guess_frequencies
from sysid.data.harmonics import evaluate, fit_harmonics
from sysid.data.local_sine import WINDOWS_PER_PERIOD, LocalSine, fit_local_sine, phase_of
from sysid.data.other_motions import OtherMotion, other_motions, several_motions
from sysid.data.record import Record
from sysid.errors import DataError

Samples = Float[np.ndarray, " n"]
Reason = Literal[
    "rest_only", "too_few_cycles", "not_sinusoidal", "several_motions", "undersampled",
    "not_finite", "current_changes",
]  # fmt: skip

SMALLEST_STROKE = 20e-6
"""Peak to peak, m: what moves less than this is at rest."""
FEWEST_SAMPLES = 8.0
"""Samples a cycle below which no loop is cut."""
DISTORTION = 0.10
"""RMS beside a sinusoid, relative to the sinusoid, up to which motion counts as sinusoidal (a
triangle has 0.121)."""
AMPLITUDE_BAND = 0.05
"""Relative band about the most frequent amplitude that the steady part may use."""
FREQUENCY_BAND = 0.05
EDGE = 0.125
"""Part of a cycle taken off beside a sample that departs: near mid-stroke a ramp hides."""
REFINEMENTS = 4
FEW_HARMONICS = 3
"""Enough for the fundamental and the rough shape; fewer than half of `FEWEST_SAMPLES`."""
SETTLED = 1e-6
"""Relative change of the frequency at which refining stops."""
WHOLE = 0.005
"""What a cycle may lack to count as whole: the error of a frequency found from one cycle."""
GAP = 0.125
"""Part of a cycle, and `GAP_STEPS` usual steps, beyond which a step of time is a gap."""
GAP_STEPS = 3.0
SMALLEST_SHARE = 0.3
"""Least share of the whole travel ∫|dx| in the steady part; random motion has sinusoidal
moments, but not mostly."""


class NoSteadyPartError(DataError):
    """A record has no steady sinusoidal cycle; `reason` says which way."""

    reason: Reason

    def __init__(self, reason: Reason, what: str, *, where: str) -> None:
        self.reason = reason
        super().__init__(what, where=where)


@dataclass(frozen=True)
class Steady:
    """Where a record moves steadily, as a view of it: nothing is copied out of the record.

    Attributes:
        start: First sample of the steady part.
        stop: One past the last sample.
        frequency: Hz, mean over the steady part.
        amplitude: m, of the fundamental, mean over the steady part.
        centre: m, mean displacement of the steady part in the record's coordinate.
        phase: [stop − start] rad, of the fundamental x₁ = A sin φ, increasing; it follows slow
            wander of the frequency.
        time_since_rest: [stop − start] s since the motion last began.
        left_out: What is not steady, one sentence each.
        others: What of it may be a test of its own, one sentence each.
    """

    start: int
    stop: int
    frequency: float
    amplitude: float
    centre: float
    phase: Samples
    time_since_rest: Samples
    left_out: tuple[str, ...]
    others: tuple[str, ...] = ()

    @property
    def cycles(self) -> int:
        """Number of whole cycles; the last sample stands for the step that follows it."""
        return int(np.floor(_turns(self.phase) + WHOLE))

    @property
    def samples_per_cycle(self) -> float:
        """Mean number of samples in a cycle."""
        return 2.0 * np.pi * (self.phase.size - 1) / (self.phase[-1] - self.phase[0])

    @property
    def sample_cycle(self) -> Int[np.ndarray, " n"]:
        """[stop − start] index of each sample's cycle; −1 after the last whole cycle."""
        index = np.floor((self.phase - self.phase[0]) / (2.0 * np.pi)).astype(np.int64)
        return np.where(index < self.cycles, index, -1)


def _turns(phase: Samples) -> float:
    """Cycles that samples cover, each sample standing for one step."""
    return float((phase[-1] - phase[0]) / (2.0 * np.pi) * phase.size / (phase.size - 1))


def find_steady(record: Record) -> Steady:
    """Find the longest part that is a steady sinusoid, its true frequency and amplitude.

    A sinusoid is fitted to each sliding window of one period; windows that leave little beside
    the sinusoid, at the prevailing amplitude and frequency, are steady.  Labels play no part.
    No part goes across a gap in time: what the force did there is not known.
    At the edges, samples that depart from the loop's own harmonics are taken off again, so that
    the end of a ramp does not leak in, and so is the edge that another steady motion touches.

    Raises:
        NoSteadyPartError: Rest only, less than one whole cycle, not sinusoidal, several motions
            none of which prevails, fewer than `FEWEST_SAMPLES` samples a cycle, or values that are
            not numbers.
    """
    return _find(record, whole=True)


def _find(record: Record, *, whole: bool = False) -> Steady:
    """The steady part; of a `whole` record, beside it what else moves steadily."""
    _refuse_hopeless(record)
    time, x = record.time, record.displacement
    candidates = [
        _longest_run(time, x, guess) for guess in guess_frequencies(time, x, FEWEST_SAMPLES)
    ]
    found = [run for run in candidates if run is not None]
    if any(run[0].time.size == 0 for run in found):
        found = [run for run in found if run[0].time.size]
        if not found:
            text = f"gaps in time of more than {GAP:g} of a cycle leave no whole cycle between them"
            raise NoSteadyPartError("undersampled", text, where=record.id)
    if not found:
        several = several_motions(record, _find) if whole else None
        why = _why_none(time, x) if several is None else ("several_motions", several)
        raise NoSteadyPartError(*why, where=record.id)
    fit, frequency = max(found, key=lambda run: run[0].time.size / run[1])
    start, stop = _edges(time, x, fit, frequency)
    others = other_motions(record, start, stop, _find) if whole else ()
    start, stop = _off_seams(time, (start, stop), others, frequency)
    fit = _inside(fit, time[start], time[stop - 1], frequency)
    phase = phase_of(fit, time[start:stop], time[0], frequency)
    return _describe(record, start, stop, fit, phase, others)


def _refuse_hopeless(record: Record) -> None:
    """Refuse what cannot hold a cycle whatever its frequency."""
    x = record.displacement
    for name, values in (("time", record.time), ("displacement", x), ("force", record.force)):
        bad = int(np.sum(~np.isfinite(values)))
        if bad:
            text = f"{bad} of {values.size} values of {name} are not numbers"
            raise NoSteadyPartError("not_finite", text, where=record.id)
    if x.size < FEWEST_SAMPLES:
        text = f"only {x.size} samples"
        raise NoSteadyPartError("too_few_cycles", text, where=record.id)
    stroke, jitter = float(np.ptp(x)), float(np.sqrt(np.mean(np.diff(x) ** 2)))
    if stroke < SMALLEST_STROKE or jitter > float(np.std(x)) * 1.2:
        text = f"no motion beyond noise: displacement stays within {1e3 * stroke:.3g} mm"
        raise NoSteadyPartError("rest_only", text, where=record.id)


def _why_none(time: Samples, x: Samples) -> tuple[Reason, str]:
    """Say why no window of one period is a steady sinusoid."""
    duration = float(time[-1] - time[0])
    crossings = np.sum(np.diff(np.sign(x - 0.5 * (x.min() + x.max()))) != 0)
    if crossings <= 2:
        text = f"less than one whole cycle in {duration:.4g} s"
        return "too_few_cycles", text
    per_cycle = 2.0 * x.size / crossings
    if per_cycle < FEWEST_SAMPLES:
        return "undersampled", f"only about {per_cycle:.1f} samples a cycle"
    return "not_sinusoidal", "the motion is not a steady sinusoid for one whole cycle"


def _longest_run(time: Samples, x: Samples, guess: float) -> tuple[LocalSine, float] | None:
    """Refine a frequency and return the longest steady run of windows with it.

    No window at all where gaps in time lie in every one of a steady run.
    """
    frequency = guess
    duration = float(time[-1] - time[0]) * time.size / (time.size - 1)
    for attempt in range(REFINEMENTS):
        if frequency * duration < 1.0 - WHOLE or frequency * duration > time.size:
            return None
        fit = fit_local_sine(time, x, frequency)
        good = fit.residual < DISTORTION
        if not np.any(good):
            return None
        level = _prevailing(fit.amplitude[good])
        if level == 0.0:
            return None
        departure = np.abs(fit.amplitude / level - 1.0)
        better = float(np.median(fit.frequency[good & (departure < 2.0 * AMPLITUDE_BAND)]))
        if abs(better / frequency - 1.0) < SETTLED or attempt == REFINEMENTS - 1:
            steady = good & (departure < AMPLITUDE_BAND)
            steady &= np.abs(fit.frequency / better - 1.0) < FREQUENCY_BAND
            if not np.any(steady):
                return None
            run = fit.select(slice(*longest_true(steady)))
            if _travel(time, x, run, 1.0 / frequency) < SMALLEST_SHARE:
                return None
            sound = _without_gaps(time, run.time, better)
            kept = slice(*longest_true(sound)) if sound.any() else slice(0)
            return run.select(kept), frequency
        frequency = better
    return None


def _prevailing(amplitude: Samples) -> float:
    """The amplitude about which most travel is done within `AMPLITUDE_BAND`."""
    ordered = np.sort(amplitude)
    total = np.concatenate([[0.0], np.cumsum(ordered)])
    low = np.searchsorted(ordered, ordered * (1.0 - AMPLITUDE_BAND))
    high = np.searchsorted(ordered, ordered * (1.0 + AMPLITUDE_BAND), side="right")
    best = int(np.argmax(total[high] - total[low]))
    return float(np.median(ordered[low[best] : high[best]]))


def longest_true(mask: Bool[np.ndarray, " n"]) -> tuple[int, int]:
    """First index and one past the last of the longest run of True."""
    edge = np.diff(np.concatenate([[0], mask.astype(np.int8), [0]]))
    starts, stops = np.flatnonzero(edge == 1), np.flatnonzero(edge == -1)
    k = int(np.argmax(stops - starts))
    return int(starts[k]), int(stops[k])


def gaps_in(time: Samples, frequency: float) -> Int[np.ndarray, " gap"]:
    """Samples behind which time makes a step too large to say what happened in it.

    Args:
        time: [n] s.
        frequency: Hz, of the motion.
    """
    step = np.diff(time)
    return np.flatnonzero(step > max(GAP / frequency, GAP_STEPS * float(np.median(step))))


def _without_gaps(time: Samples, middle: Samples, frequency: float) -> Bool[np.ndarray, " window"]:
    """Windows of one period, by their middles, that reach into no gap."""
    half, slack = 0.5 / frequency, 1e-6 / frequency
    sound = np.ones(middle.size, dtype=bool)
    for k in gaps_in(time, frequency):
        sound &= (middle + half <= time[k] + slack) | (middle - half >= time[k + 1] - slack)
    return sound


def _travel(time: Samples, x: Samples, run: LocalSine, period: float) -> float:
    """Share of the whole travel that lies in a run of windows."""
    step = np.abs(np.diff(x))
    inside = (time[1:] >= run.time[0] - 0.5 * period) & (time[1:] <= run.time[-1] + 0.5 * period)
    return float(np.sum(step[inside]) / np.sum(step))


def _inside(fit: LocalSine, first: float, last: float, frequency: float) -> LocalSine:
    """Windows that lie wholly between two times (the one nearest the middle if none does)."""
    half = 0.5 / frequency
    slack = 0.5 / (WINDOWS_PER_PERIOD * frequency)
    keep = (fit.time - half >= first - slack) & (fit.time + half <= last + slack)
    if not np.any(keep):
        middle = int(np.argmin(np.abs(fit.time - 0.5 * (first + last))))
        return fit.select(slice(middle, middle + 1))
    low, high = longest_true(keep)
    return fit.select(slice(low, high))


def _edges(time: Samples, x: Samples, fit: LocalSine, frequency: float) -> tuple[int, int]:
    """Take off samples at both ends that depart from the loop's own harmonics."""
    period = 1.0 / frequency
    start = int(np.searchsorted(time, fit.time[0] - 0.5 * period * (1 + 1e-9)))
    stop = int(np.searchsorted(time, fit.time[-1] + 0.5 * period * (1 + 1e-9), side="right"))
    inner = _inside(fit, fit.time[0], fit.time[-1], frequency)
    if fit.time[-1] - fit.time[0] < 1.5 * period:
        return start, stop
    t, y = time[start:stop], x[start:stop]
    phase = phase_of(inner, t, time[0], frequency)
    scale = np.interp(t, inner.time, inner.amplitude)
    shape = (y - np.interp(t, inner.time, inner.centre)) / scale
    core = (t >= fit.time[0]) & (t <= fit.time[-1])
    loop = fit_harmonics(phase[core], shape[core], FEW_HARMONICS)
    departure = np.abs(shape - loop.mean - evaluate(loop.harmonics, phase))
    tolerance = max(0.01, 5.0 * float(np.sqrt(np.mean(loop.residual**2))))
    bad = np.flatnonzero(departure > tolerance)
    before, after = bad[t[bad] < fit.time[0]], bad[t[bad] > fit.time[-1]]
    shy = int(np.ceil(EDGE * core.sum() * period / (fit.time[-1] - fit.time[0])))
    head = int(before[-1]) + 1 + shy if before.size else 0
    tail = int(after[0]) - shy if after.size else t.size
    return start + head, start + tail


def _off_seams(
    time: Samples, steady: tuple[int, int], others: tuple[OtherMotion, ...], frequency: float
) -> tuple[int, int]:
    """Take off the edges that another motion touches: its first sample may lie on the loop."""
    (start, stop), edge = steady, EDGE / frequency
    sides = {other.side for other in others if other.touches}
    if "before" in sides:
        start = int(np.searchsorted(time, time[start] + edge))
    if "after" in sides:
        stop = int(np.searchsorted(time, time[stop - 1] - edge, side="right"))
    return start, stop


def _describe(
    record: Record,
    start: int,
    stop: int,
    fit: LocalSine,
    phase: Samples,
    others: tuple[OtherMotion, ...],
) -> Steady:
    """Fit the whole steady part once more and say what was left out."""
    time, x = record.time, record.displacement
    cycles = _turns(phase)
    if cycles < 1.0 - WHOLE:
        text = f"only {cycles:.2f} of a cycle is a steady sinusoid"
        raise NoSteadyPartError("too_few_cycles", text, where=record.id)
    per_cycle = (stop - start) / cycles
    if per_cycle < FEWEST_SAMPLES:
        text = f"only {per_cycle:.1f} samples a cycle, at least {FEWEST_SAMPLES:g} are needed"
        raise NoSteadyPartError("undersampled", text, where=record.id)
    loop = fit_harmonics(phase, x[start:stop], FEW_HARMONICS)
    phase = phase + float(np.angle(loop.harmonics[0]))
    frequency = _mean_frequency(time[start:stop], phase)
    amplitude = float(np.abs(loop.harmonics[0]))
    begin = _motion_start(x, start, amplitude)
    return Steady(
        start=start,
        stop=stop,
        frequency=frequency,
        amplitude=amplitude,
        centre=loop.mean,
        phase=phase - 2.0 * np.pi * np.floor(phase[0] / (2.0 * np.pi)),
        time_since_rest=time[start:stop] - time[begin],
        left_out=_sentences(time, x, (start, stop), begin, amplitude, frequency, others),
        others=tuple(other.words for other in others),
    )


def _mean_frequency(time: Samples, phase: Samples) -> float:
    """Slope of the phase over time by least squares, Hz."""
    t = time - np.mean(time)
    return float(np.sum(t * phase) / np.sum(t * t) / (2.0 * np.pi))


def _motion_start(x: Samples, start: int, amplitude: float) -> int:
    """Last sample before the steady part at which the rig still rested (0 if it never did)."""
    if start < 2:
        return 0
    rest = np.median(x[: max(start // 10, 2)])
    moving = np.abs(x[:start] - rest) > 0.01 * amplitude
    return int(np.argmax(moving)) if np.any(moving) else start


def _sentences(
    time: Samples,
    x: Samples,
    steady: tuple[int, int],
    begin: int,
    amplitude: float,
    frequency: float,
    others: tuple[OtherMotion, ...],
) -> tuple[str, ...]:
    """What lies before and after the steady part."""
    start, stop = steady
    gaps, told = gaps_in(time, frequency), []
    for name, part in (("before", slice(0, start)), ("after", slice(stop, None))):
        t = time[part]
        if t.size == 0:
            continue
        moves = float(np.ptp(x[part])) > 0.02 * amplitude
        kind = "rest and ramp" if moves else "rest"
        if name == "before" and moves and begin == 0:
            kind = "motion that is not steady"
        if any(other.side == name for other in others):
            kind = "a motion of its own"
        if np.any(gaps < start if name == "before" else gaps >= stop - 1):
            kind = "beside a gap in time"
        told.append(
            f"{t.size} samples {name} the steady part ({t[0]:.4g} to {t[-1]:.4g} s, {kind})"
            " are left out of the loop"
        )
    return tuple(told)
