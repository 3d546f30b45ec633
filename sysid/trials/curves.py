"""What rates alone do not show: is stated confidence kept, and how much does size help."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
from scipy.special import ndtr, ndtri

from sysid.trials.outcome import Row
from sysid.trials.proportions import Share
from sysid.trials.score import RIGHT
from sysid.trials.visible import DETECTED, Visibility

CONFIDENCES: Final = (0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0)
"""Edges of the bins of stated confidence; the last bin holds 1 as well."""
DISTANCES: Final = (0.0, 2.0, 4.5, 8.0, 16.0, 32.0, 64.0, float("inf"))
"""Edges of the bins of d′."""


@dataclass(frozen=True)
class Calibrated:
    """Names of about one confidence.

    Attributes:
        low: Smallest confidence of the bin.
        high: Largest.
        stated: Their mean confidence.
        right: Those that are right.
    """

    low: float
    high: float
    stated: float
    right: Share


@dataclass(frozen=True)
class Power:
    """Hidden effects that are about as visible.

    Attributes:
        low: Smallest d′ of the bin.
        high: Largest.
        found: Right name, or class with the test that splits it.
        ideal: Mean probability of detecting and rightly naming it at best.
    """

    low: float
    high: float
    found: Share
    ideal: float


def calibration(rows: Sequence[Row]) -> tuple[Calibrated, ...]:
    """Names and classes by the confidence that they were given with."""
    names = [
        (j.given.confidence, j.verdict in RIGHT)
        for row in rows
        if row.score is not None
        for j in row.score.judged
        if j.given.status in ("named", "class")
    ]
    made = []
    for low, high in pairwise(CONFIDENCES):
        inside = [(c, ok) for c, ok in names if low <= c < high or c == high == 1.0]
        if inside:
            stated, right = (np.array(z) for z in zip(*inside, strict=True))
            share = Share(int(right.sum()), len(inside))
            made.append(Calibrated(low, high, float(stated.mean()), share))
    return tuple(made)


def power(rows: Sequence[Row]) -> tuple[Power, ...]:
    """Hidden effects of the catalogue by their d′, each of them counted once."""
    seen = [
        (bound, verdict in RIGHT)
        for row in rows
        if row.score is not None and len(row.score.found) == len(row.visibility)
        for bound, verdict in zip(row.visibility, row.score.found, strict=True)
    ]
    made = []
    for low, high in pairwise(DISTANCES):
        inside = [(bound, ok) for bound, ok in seen if low <= bound.distance < high]
        if inside:
            found = Share(sum(ok for _, ok in inside), len(inside))
            made.append(Power(low, high, found, float(np.mean([ideal(b) for b, _ in inside]))))
    return tuple(made)


def ideal(bound: Visibility) -> float:
    """Probability that an effect is detected, and then rightly named, at best.

    Detection by the test whose power is 80 % at `DETECTED`: Φ(d′ − DETECTED + Φ⁻¹(0.8)).
    """
    detected = float(ndtr(bound.distance - DETECTED + ndtri(0.8)))
    return detected * bound.right
