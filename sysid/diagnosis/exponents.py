"""How a residual grows with amplitude, frequency and current: exponents of its size."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.special import stdtrit

from sysid.data.loops import Loops
from sysid.identification.straight_lines.levels import (
    AMPLITUDE_GAP,
    FREQUENCY_GAP,
    current_levels,
    grouped,
)

REST: Final = 0.01
"""Share of the largest current below which a supply was meant to give none."""


@dataclass(frozen=True)
class Exponent:
    """RMS ∝ quantity^value, the other quantities held.

    Attributes:
        quantity: "amplitude", "frequency" or "current".
        value: The exponent; NaN where the tests do not vary the quantity apart from the others.
        low: Lower end of the 95 % interval.
        high: Upper end.
    """

    quantity: str
    value: float
    low: float
    high: float


def exponents(
    loops: Loops,
    size: Float[np.ndarray, " loop"],
    weight: Float[np.ndarray, " loop"] | None = None,
) -> tuple[Exponent, ...]:
    """Exponents of A, f and i in size ∝ A^p f^q i^r, by a straight line in logarithms.

    What was meant to be one amplitude, frequency or current counts as one: how actuators and
    supplies miss it tells nothing of how a residual grows.  So a quantity that the campaign has at
    one level only has no exponent, nor have two that always change together.  Tests without
    current have no logarithm of it; where some have, r is found from those with current alone, and
    p and q from all tests with one level for each current.

    Args:
        loops: L tests.
        size: [L] N, RMS of a part of the residual; tests where it is zero are left out.
        weight: [L], of each test's logarithm; all alike if None, so that the smallest sizes count
            as much as the largest.  With the size itself, what is minimised is an error of the
            size in newtons, and what is found holds where the residual is large.
    """
    current = _meant_current(loops.current)
    levels = [np.isnan(current), *(current == i for i in np.unique(current[~np.isnan(current)]))]
    level = {f"level {k}": inside.astype(float) for k, inside in enumerate(levels)}
    motion = {
        "amplitude": _meant(np.log(loops.amplitude), AMPLITUDE_GAP),
        "frequency": _meant(np.log(loops.frequency), FREQUENCY_GAP),
    }
    usable = size > 0.0
    weight = np.ones(size.size) if weight is None else weight
    found = _regress({**motion, **level}, size, weight, usable)
    flowing = usable & (current > 0.0)
    table = {**motion, "constant": np.ones(size.size)}
    table["current"] = np.log(np.where(current > 0.0, current, 1.0))
    found["current"] = _regress(table, size, weight, flowing).get("current", _unknown("current"))
    return tuple(found[name] for name in ("amplitude", "frequency", "current"))


def _meant(values: Float[np.ndarray, " loop"], gap: float) -> Float[np.ndarray, " loop"]:
    """Each value as it was meant: the median of its level."""
    meant = np.empty_like(values)
    for places in grouped(values, gap):
        meant[places] = np.median(values[places])
    return meant


def _meant_current(current: Float[np.ndarray, " loop"]) -> Float[np.ndarray, " loop"]:
    """Sizes of currents as they were meant, A; what a supply leaves at zero is zero."""
    known = np.flatnonzero(np.isfinite(current))
    meant = np.full(current.shape, np.nan)
    if known.size:
        levels = current_levels(current[known])
        largest = levels[-1][0]
        for level, places in levels:
            meant[known[places]] = level if level > REST * largest else 0.0
    return meant


def _regress(
    columns: Mapping[str, Float[np.ndarray, " loop"]],
    size: Float[np.ndarray, " loop"],
    weight: Float[np.ndarray, " loop"],
    usable: np.ndarray,
) -> dict[str, Exponent]:
    """Exponents of all columns; unknown ones where a column is a combination of the others."""
    names = list(columns)
    table = np.stack([columns[name][usable] for name in names], axis=1)
    kept = np.abs(table).max(axis=0, initial=0.0) > 0.0
    table, names = table[:, kept], [n for n, keep in zip(names, kept, strict=True) if keep]
    spare = table.shape[0] - table.shape[1]
    if spare < 1:
        return {name: _unknown(name) for name in columns}
    y = weight[usable] * np.log(size[usable])
    table = weight[usable][:, None] * table
    value = np.linalg.lstsq(table, y, rcond=None)[0]
    variance = np.sum((y - table @ value) ** 2) / spare
    _, singular, right = np.linalg.svd(table, full_matrices=False)
    solid = singular > 1e-8 * singular[0]
    spread = np.sqrt(variance * np.sum((right[solid] / singular[solid, None]) ** 2, axis=0))
    open_share = np.sum(right[~solid] ** 2, axis=0) if (~solid).any() else np.zeros(len(names))
    reach = float(stdtrit(spare, 0.975)) * spread
    found = {name: _unknown(name) for name in columns}
    for k, name in enumerate(names):
        if open_share[k] < 1e-6:
            v = float(value[k])
            found[name] = Exponent(name, v, v - float(reach[k]), v + float(reach[k]))
    return found


def _unknown(quantity: str) -> Exponent:
    nan = float("nan")
    return Exponent(quantity, nan, nan, nan)
