"""Sampling: too slow for the force, uneven, or with gaps."""

import numpy as np

from sysid.data.quality.fault import Fault, graded
from sysid.data.quality.subject import Subject
from sysid.data.steady import gaps_in
from sysid.data.timebase import TIME_CHANGE

UNRESOLVED = (0.02, 0.10)
"""Share of the force's RMS in the upper half of the harmonics that one cycle can hold, from which
on it is a note, and a warning: what lies there continues beyond and folds back."""
FEWEST = 20.0
"""Samples a cycle below which a loop is cut all the same, but rounded."""
JITTER = (0.01, 0.25)
GAP = 1.5


def check_aliasing(subject: Subject) -> list[Fault]:
    """Content of the force near and beyond half the sampling rate; labels beyond it."""
    record, steady, loop = subject.record, subject.steady, subject.loop
    rate = (record.time.size - 1) / float(record.time[-1] - record.time[0])
    label = record.nominal.frequency
    if label is not None and label > 0.5 * rate:
        text = f"a label of {label:.4g} Hz cannot be sampled at {rate:.4g} Hz"
        return [Fault("aliasing", "fatal", text)]
    if subject.reason == "undersampled":
        return [Fault("aliasing", "fatal", subject.left_out or "too few samples a cycle")]
    if steady is None or loop is None:
        return []
    per_cycle = steady.samples_per_cycle
    if per_cycle < FEWEST:
        text = (
            f"only {per_cycle:.1f} samples a cycle: knees and peaks of the force fall between "
            f"them; record {FEWEST:g} or more"
        )
        return [Fault("aliasing", "warning", text)]
    power = np.abs(np.fft.rfft(loop.force)[1:]) ** 2
    if loop.cycles > 1:
        scatter = np.abs(np.fft.rfft(loop.deviations, axis=1)[:, 1:]) ** 2
        power = np.maximum(power - scatter.sum(axis=0) / (loop.cycles * (loop.cycles - 1)), 0.0)
    upper = int(per_cycle / 4.0)
    share = float(np.sqrt(power[upper:].sum() / power.sum())) if power.sum() > 0 else 0.0
    text = (
        f"{100 * share:.1f} % of the force's RMS lies above a quarter of the sampling rate "
        f"({per_cycle:.0f} samples a cycle)"
    )
    return graded("aliasing", share, *UNRESOLVED, text)


def check_time(subject: Subject) -> list[Fault]:
    """Steps of the time stamps: uneven, with gaps, or repaired on reading."""
    record, faults = subject.record, []
    step = np.diff(record.time)
    usual = float(np.median(step))
    gaps = step > GAP * usual
    if np.any(gaps) and gaps.mean() < 0.05:
        text = (
            f"{int(gaps.sum())} gaps in the time stamps, the longest of {1e3 * step.max():.4g} ms "
            f"at {record.time[int(np.argmax(step))]:.4g} s, where {1e3 * usual:.4g} ms are usual"
        )
        steady = subject.steady
        if steady is not None and gaps_in(record.time, steady.frequency).size:
            text += f"; the loop is of {steady.cycles} cycles between gaps, the rest is left out"
        faults.append(Fault("time_irregular", "warning", text))
        step = step[~gaps]
    uneven = float(np.std(step)) / usual
    text = f"the time between samples scatters by {100 * uneven:.1f} % about {1e3 * usual:.4g} ms"
    faults += graded("time_irregular", uneven, *JITTER, text)
    for change in record.source.changes:
        if change.startswith(TIME_CHANGE):
            faults.append(Fault("time_irregular", "note", change))
    return faults
