"""Start values of the generalised model: features of loops regressed on v_m and current."""

from typing import Final

import numpy as np
from scipy.optimize import nnls

from sysid.identification.features import LoopFeatures
from sysid.identification.starts.ordinary import ordinary_loops
from sysid.models.coordinates import place_of
from sysid.models.generalized import Generalized
from sysid.models.generalized_coordinates import GeneralizedCoordinates
from sysid.parameters import build

# Middle of the logistic laws in current: half-way through their bend at the largest current.
_BEND, _BEND_START = 2.5, 1.0
_TOLD: Final = 1e-2
"""Singular value, parts of the largest, below which tests tell nothing of a column: currents that
are one setting of the supply differ by a little."""


def generalized_start(
    features: LoopFeatures | None, coordinates: GeneralizedCoordinates
) -> np.ndarray:
    """The start that the features suggest, [n] solver coordinates.

    Plateau: log P = log 2F_0 + ½a_1 v_m + … in v_m and i; slope at zero force: P a/2, and 1/a is a
    line in v_m (Eq. 6); width: a line in i (Eq. 7); rise at high speed: its median (Eq. 9).
    What tests of few currents or speeds do not tell is nil: at one current none depends on it.
    Without loops (random motion only) the middle of what dampers are, in units of the campaign.
    """
    if features is None:
        features = ordinary_loops(coordinates.reference)
    reference = coordinates.reference
    V, current = float(reference.speed), float(reference.current)
    speed, i = features.peak_velocity / V, features.current / current
    force = float(reference.force)
    plateau = np.maximum(features.plateau, 1e-3 * force)
    # about the largest current and the fastest test, where there are tests for certain
    table = np.stack([np.ones_like(speed), speed - 1.0, i - 1.0, (i - 1.0) ** 2], axis=1)
    fastest, per_speed, per_current, bend = _line(table, np.log(plateau / force))
    rise_by_current = np.clip(per_current - bend, 0.1, 5.0)
    level = fastest - per_speed - rise_by_current
    p, q = _steepness(features.slope / plateau, features.peak_velocity)
    width_0, width_1 = _width(features.width, i)
    rise = np.clip(np.median(features.rise, axis=0), 0.05 / V, 20.0 / V)
    a_1 = float(np.clip(per_speed, 0.05, 5.0)) / V
    b = _BEND / current
    valve = build(Generalized, {
        "F_0": 0.5 * force * np.exp(level), "a_1": a_1,
        "k_2": np.expm1(rise_by_current) / _rise(_BEND, _BEND_START),
        "a_2": b, "I_0": _BEND_START / b,
        "k_4": width_0, "k_3": (width_1 / width_0 - 1.0) / _rise(_BEND, _BEND_START),
        "a_3": b, "I_1": _BEND_START / b,
        "a_0": 1.0 / p, "k_0": q / p,
        "k_1c": rise[0] * np.e, "k_1e": rise[1] * np.e, "a_4": 2.0 / V,
        "k_5": 0.1, "k_6": 0.1,
    })  # fmt: skip
    return np.asarray(place_of(coordinates, valve))


def _steepness(slope: np.ndarray, v_m: np.ndarray) -> tuple[float, float]:
    """(p, q) of 1/a = p + q v_m with slope/plateau = a/2; relative residuals, p, q > 0."""
    inverse = 0.5 / np.maximum(slope, 1e-9)
    table = np.stack([1.0 / inverse, v_m / inverse], axis=1)
    p, q = nnls(table, np.ones_like(v_m))[0]
    smallest = 1e-3 * np.median(inverse)
    return max(p, smallest), max(q, smallest / float(v_m.max()))


def _line(table: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Least squares; of what the rows do not tell apart the smallest."""
    return np.linalg.lstsq(table, values, rcond=_TOLD)[0]


def _width(width: np.ndarray, i: np.ndarray) -> tuple[float, float]:
    """Width over v_m at 0 A and at the largest current, same sign, the second the larger."""
    end, slope = _line(np.stack([np.ones_like(i), i - 1.0], axis=1), width)
    level = end - slope
    if abs(end) < 1e-3:
        end = -1e-3
    return float(np.clip(level / end, 0.1, 0.9) * end), float(end)


def _rise(b: float, c: float) -> float:
    return float(1.0 / (1.0 + np.exp(-b - c)) - 1.0 / (1.0 + np.exp(-c)))
