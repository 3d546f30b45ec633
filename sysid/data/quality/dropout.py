"""Brief excursions of a channel from the loop that its cycles share."""

import numpy as np
from jaxtyping import Bool, Float

from sysid.data.figures import figure
from sysid.data.quality.fault import Fault
from sysid.data.quality.resolution import resolution
from sysid.data.quality.subject import Subject

JITTER = 15.0 / 360.0
"""Part of a cycle by which a jump of the loop may come earlier or later in one cycle."""
SLOW = 0.25
"""Part of a cycle over which the running median follows slow change; half of it is brief."""
FALSE_ALARM = 1e-3
"""Chance that Gaussian noise alone flags a test."""
TAILS = 2.0
"""Allowance for noise with heavier tails than Gaussian, in its standard deviation."""
MATERIAL = 0.05
"""Smallest excursion that matters, relative to the channel's size."""
STEPS = 1.5
"""Smallest excursion that matters, in steps of the converter: one more or less is no drop-out."""
FEWEST_CYCLES = 3


def check_dropout(subject: Subject) -> list[Fault]:
    """Force or displacement that briefly leaves the loop, in some cycles only.

    The residual of each sample from the median of the cycles, less its running median over a
    quarter of a cycle (slow change from cycle to cycle is drift), must exceed what the loop does
    itself within ±15° of that phase (a jump that wanders is none) by more than noise explains:
    k σ, with k for a family-wise false alarm of `FALSE_ALARM` times `TAILS`, σ from the median
    magnitude of the residual (which excursions do not raise); and by `MATERIAL` of the peak and
    `STEPS` of the converter.
    """
    loop, steady = subject.loop, subject.steady
    if loop is None or steady is None or loop.cycles < FEWEST_CYCLES:
        return []
    faults = []
    for name, unit, values, cycles, size in (
        ("force", "N", subject.record.force, loop.force + loop.deviations, subject.peak_force),
        (
            "displacement",
            "m",
            subject.record.displacement - loop.centre,
            loop.displacement + loop.displacement_deviations,
            loop.amplitude,
        ),
    ):
        part = subject.steady_part(values)
        found = excursions(part, steady.phase, cycles)
        material = found > max(MATERIAL * size, STEPS * resolution(part))
        count = _events(material, max(1, int(JITTER * steady.samples_per_cycle)))
        if count:
            worst = int(np.argmax(found))
            time = subject.record.time[steady.start + worst]
            text = (
                f"{name} leaves the loop briefly {count} times in {loop.cycles} cycles, most by "
                f"{figure(found[worst], 3)} {unit} ({100 * found[worst] / size:.0f} % of the peak) "
                f"at {time:.4g} s"
            )
            faults.append(Fault("dropout", "warning", text))
    return faults


def excursions(
    values: Float[np.ndarray, " n"],
    phase: Float[np.ndarray, " n"],
    cycles: Float[np.ndarray, "cycle phase"],
) -> Float[np.ndarray, " n"]:
    """How far each sample is outside of what loop and noise explain, 0 where they do.

    Args:
        values: [n] samples of the steady part.
        phase: [n] rad.
        cycles: [cycles, J] the same on the phase grid.
    """
    from scipy.ndimage import maximum_filter1d, minimum_filter1d
    from scipy.special import ndtri

    points = cycles.shape[1]
    centre = np.median(cycles, axis=0)
    width = 2 * int(np.ceil(JITTER * points)) + 1
    rise = maximum_filter1d(centre, width, mode="wrap") - centre
    fall = centre - minimum_filter1d(centre, width, mode="wrap")
    grid = 2.0 * np.pi * np.arange(points) / points
    angle = phase % (2.0 * np.pi)

    def at_samples(curve: np.ndarray) -> np.ndarray:
        return np.interp(angle, grid, curve, period=2.0 * np.pi)

    residual = values - at_samples(centre)
    per_cycle = 2.0 * np.pi * (phase.size - 1) / (phase[-1] - phase[0])
    brief = residual - _running_median(residual, SLOW * per_cycle)
    sigma = 1.4826 * float(np.median(np.abs(brief)))
    allowed = TAILS * -float(ndtri(0.5 * FALSE_ALARM / phase.size)) * sigma
    beyond = np.where(brief > 0, brief - at_samples(rise), -brief - at_samples(fall))
    return np.where(beyond > allowed, beyond, 0.0)


def _running_median(values: Float[np.ndarray, " n"], width: float) -> Float[np.ndarray, " n"]:
    """Median over `width` samples, from medians of blocks a tenth as long, interpolated."""
    from scipy.ndimage import median_filter

    block = max(1, int(width / 10.0))
    count = values.size // block
    blocks = np.median(values[: count * block].reshape(count, block), axis=1)
    # mirrored: at the end of a record, the last block alone would be most of its own surroundings
    smooth = median_filter(blocks, 2 * max(1, int(0.5 * width / block)) + 1, mode="reflect")
    middle = block * (np.arange(count) + 0.5) - 0.5
    return np.interp(np.arange(values.size), middle, smooth)


def _events(flag: Bool[np.ndarray, " n"], apart: int) -> int:
    """Number of groups of flagged samples that are more than `apart` samples from each other."""
    where = np.flatnonzero(flag)
    return 0 if where.size == 0 else 1 + int(np.sum(np.diff(where) > apart))
