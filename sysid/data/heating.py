"""Tests recorded while the damper heats or cools → consecutive parts, each at its temperature.

A loop belongs to one temperature.  A record whose temperature moves by more than a few kelvin is
therefore cut into parts of whole cycles; every sample of it stays in a part, but those beyond a gap
in time.
"""

import re
from dataclasses import replace
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.data.local_sine import WINDOWS_PER_PERIOD
from sysid.data.record import Record, Source
from sysid.data.steady import NoSteadyPartError, Steady, find_steady, gaps_in

Cycles = Float[np.ndarray, " cycle"]

STEP: Final = 5.0
"""K by which the temperature may move in a test that stays whole, unless the manifest says else.

It is what `sysid check` warns of (`quality.drift`), and the spacing of BS09's temperatures."""
FEWEST_CYCLES: Final = 3
"""In a part; with fewer repeatability would rest on one difference."""
_FINE: Final = 0.1
"""Noise of the smoothed temperature that is looked for, in steps."""
_SURE: Final = 4.0
"""Standard errors by which a movement must exceed the step."""
_BEYOND: Final = 1.5 / WINDOWS_PER_PERIOD
"""Part of a cycle that a part runs on into the next, so that its last cycle is found whole."""
_BISECTIONS: Final = 30
_PART: Final = re.compile(r"@-?\d+\.\dC(_\d+)?$")
"""End of a part's id."""


def cut_by_temperature(record: Record, step: float = STEP) -> tuple[tuple[Record, ...], str | None]:
    """Cut a test in which the temperature moves by more than a step.

    The parts follow each other: the first begins with the record's rest and ramp, the last ends
    with it (either at a gap in time, if there is one), and between them they are cut where a steady
    cycle begins (a tenth of a cycle there is in both, so that cycles are found whole; it is in one
    loop only).  They are as few, and their ranges of temperature as equal, as parts of at most one
    step and at least `FEWEST_CYCLES` cycles can be.  The temperature may rise, fall, or turn.  What
    counts is the median in each cycle, averaged over as many cycles as its noise demands.

    Args:
        record: Any test.
        step: K.

    Returns:
        The parts, named like ``10mm_8Hz_1A@17.4C`` after their mean temperature (the record itself
        where it stays whole), and what is to be said about it.
    """
    warm = record.temperature
    if warm is None or record.nominal.kind != "sine" or not np.isfinite(warm).all():
        return (record,), None
    if float(np.ptp(warm)) <= step:
        return (record,), None
    try:
        steady = find_steady(record)
    except NoSteadyPartError:
        return (record,), None
    smooth, error = _smoothed(_each_cycle(warm, steady), step)
    edges = _edges(smooth)
    if float(np.ptp(edges)) <= step + _SURE * error:
        return (record,), None
    why = (
        f"the temperature goes from {edges[0]:.1f} to {edges[-1]:.1f} °C in {steady.cycles} "
        "steady cycles"
    )
    begins = _evenly(edges, step)
    if len(begins) == 1:
        return (record,), (
            f"{record.id}: {why}, too few to be cut by temperature; it stays one test"
        )
    ends = [*begins[1:], steady.cycles]
    around = _between_gaps(record, steady)
    parts = _parts(record, steady, around, begins, ends, why)
    spans = [float(np.ptp(edges[a : b + 1])) for a, b in zip(begins, ends, strict=True)]
    wide = sum(span > step + _SURE * error for span in spans)
    said = f"{record.id}: {why}"
    said += (
        f"; cut into {len(parts)} parts of whole cycles, {parts[0].id} … {parts[-1].id} "
        "(sweeps.cut = false in campaign.toml leaves it whole)"
    )
    if wide:
        said += (
            f"; in {wide} of them it still moves by more than {step:g} K, since no part has fewer "
            f"than {FEWEST_CYCLES} cycles"
        )
    beyond = record.time.size - (around.stop - around.start)
    if beyond:
        said += f"; {beyond} samples beyond a gap in time are in none of them"
    return parts, said


def whole_test(name: str) -> str:
    """Id of the test that a part with this id was cut from; the id itself for any other."""
    return _PART.sub("", name)


def _each_cycle(warm: Float[np.ndarray, " n"], steady: Steady) -> Cycles:
    """[cycles] median of each steady cycle, °C."""
    part, cycle = warm[steady.start : steady.stop], steady.sample_cycle
    return np.array([np.median(part[cycle == c]) for c in range(steady.cycles)])


def _smoothed(each: Cycles, step: float) -> tuple[Cycles, float]:
    """Running mean over as many cycles as the noise demands, and the noise left in it, K."""
    rise = np.diff(each)
    if rise.size < 2:
        return each, 0.0
    noise = 1.4826 * float(np.median(np.abs(rise - np.median(rise)))) / np.sqrt(2.0)
    half = min(int(0.5 * (noise / (_FINE * step)) ** 2 + 0.5), each.size // 6)
    if half == 0:
        return each, noise
    total = np.concatenate([[0.0], np.cumsum(each)])
    place = np.arange(each.size)
    low, high = np.maximum(place - half, 0), np.minimum(place + half + 1, each.size)
    return (total[high] - total[low]) / (high - low), noise / float(np.sqrt(2 * half + 1))


def _edges(smooth: Cycles) -> Cycles:
    """[cycles + 1] temperature where each cycle begins and the last ends."""
    if smooth.size < 2:
        return np.repeat(smooth, 2)
    between = 0.5 * (smooth[1:] + smooth[:-1])
    return np.concatenate([[2 * smooth[0] - between[0]], between, [2 * smooth[-1] - between[-1]]])


def _evenly(edges: Cycles, step: float) -> list[int]:
    """First cycle of each part: as few parts as the step allows, by the smallest step that does."""
    best = _greedily(edges, step)
    low, high = 0.0, step
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        found = _greedily(edges, middle)
        if len(found) <= len(best):
            best, high = found, middle
        else:
            low = middle
    if len(best) > 1 and edges.size - 1 - best[-1] < FEWEST_CYCLES:
        best.pop()
    return best


def _greedily(edges: Cycles, step: float) -> list[int]:
    """First cycle of each part, each part going on while its range is within a step."""
    begins, low, high = [0], float(edges[0]), float(edges[0])
    for cycle in range(edges.size - 1):
        end = float(edges[cycle + 1])
        low, high = min(low, end), max(high, end)
        if high - low > step and cycle - begins[-1] >= FEWEST_CYCLES:
            begins.append(cycle)
            low, high = sorted((float(edges[cycle]), end))
    return begins


def _between_gaps(record: Record, steady: Steady) -> slice:
    """The samples about the steady part that no gap in time separates from it."""
    gaps = gaps_in(record.time, steady.frequency)
    before, after = gaps[gaps < steady.start], gaps[gaps >= steady.stop - 1]
    return slice(
        int(before[-1]) + 1 if before.size else 0,
        int(after[0]) + 1 if after.size else record.time.size,
    )


def _parts(
    record: Record, steady: Steady, around: slice, begins: list[int], ends: list[int], why: str
) -> tuple[Record, ...]:
    """Records of the parts, each with its mean temperature as its condition and in its name."""
    turns = (steady.phase - steady.phase[0]) / (2.0 * np.pi)
    edges = steady.start + np.searchsorted(turns, np.array(begins) - 1e-9)
    edges = np.append(edges, steady.stop)
    beyond = int(np.ceil(_BEYOND * steady.samples_per_cycle))
    parts: list[Record] = []
    taken: dict[str, int] = {}
    for k, (begin, end) in enumerate(zip(begins, ends, strict=True)):
        inside = slice(int(edges[k]), int(edges[k + 1]))
        first, last = k == 0, k == len(begins) - 1
        piece = slice(
            around.start if first else inside.start,
            around.stop if last else min(inside.stop + beyond, around.stop),
        )
        assert record.temperature is not None
        mean = float(np.mean(record.temperature[inside]))
        name = f"{mean:.1f}C"
        taken[name] = taken.get(name, 0) + 1
        if taken[name] > 1:
            name += f"_{taken[name]}"
        said = (
            f"cycles {begin + 1} to {end} of a test that is cut by temperature ({why}); here it is "
            f"{mean:.1f} °C in the mean"
        )
        parts.append(_piece(record, piece, name, mean, said))
    return tuple(parts)


def _piece(record: Record, piece: slice, name: str, mean: float, said: str) -> Record:
    """The samples of a part as a record of their own."""
    source = record.source
    channels = {
        channel: None if values is None else values[piece]
        for channel in (
            "time", "displacement", "force", "velocity", "current", "voltage", "temperature"
        )
        for values in (getattr(record, channel),)
    }  # fmt: skip
    return replace(
        record,
        id=f"{record.id}@{name}",
        nominal=replace(record.nominal, temperature=mean, temperature_sd=None),
        source=Source(
            source.file,
            source.sha256,
            name if source.part is None else f"{source.part}@{name}",
            (*source.changes, said),
        ),
        **channels,
    )
