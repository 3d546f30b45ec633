"""The test matrix: amplitude × frequency × current × temperature, there or missing."""

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Int

from sysid.data.loops import Loops
from sysid.data.record import Conditions

if TYPE_CHECKING:
    import pandas as pd

RELATIVE = {"amplitude_m": 0.05, "frequency_Hz": 0.05, "current_A": 0.05, "temperature_degC": 0.0}
ABSOLUTE = {"amplitude_m": 0.0, "frequency_Hz": 0.0, "current_A": 0.02, "temperature_degC": 5.0}
"""Neighbours closer than this (relative to the larger, or absolute) are one level."""


ALIKE = 1.0 / 3.0
"""Of a tolerance: what steps within a level stay below, where neighbours chain to more than it."""


def test_matrix(loops: Loops, labels: Sequence[Conditions]) -> "pd.DataFrame":
    """All combinations of the levels that were measured, with the tests at each.

    Args:
        loops: L tests.
        labels: [L] what they were meant to be: a current or temperature that was measured within
            the tolerance of its label belongs to the label's level.

    Returns:
        Columns ``amplitude_m, frequency_Hz, current_A, temperature_degC`` (levels: medians;
        NaN is one level), of each also ``lowest_…`` and ``highest_…``, ``tests``
        (number) and ``ids``; ``tests`` is 0 where the combination is missing.
    """
    import pandas as pd

    columns = {
        "amplitude_m": loops.amplitude,
        "frequency_Hz": loops.frequency,
        "current_A": _as_meant("current_A", loops.current, [z.current for z in labels]),
        "temperature_degC": _as_meant(
            "temperature_degC", loops.temperature, [z.temperature for z in labels]
        ),
    }
    levels: dict[str, list[dict[str, float]]] = {}
    member: dict[str, np.ndarray] = {}
    unlabelled = bool(np.any(columns["temperature_degC"] == loops.temperature))
    for name, values in columns.items():
        several = 2 if name == "temperature_degC" and unlabelled else 1
        medians, member[name] = find_levels(values, RELATIVE[name], ABSOLUTE[name], several)
        inside = [values[member[name] == k] for k in range(medians.size)]
        levels[name] = [
            {name: median, f"lowest_{name}": z.min(), f"highest_{name}": z.max()}
            for median, z in zip(medians, inside, strict=True)
        ]
    cells: dict[tuple[int, ...], list[str]] = {}
    for k, test in enumerate(loops.ids):
        cells.setdefault(tuple(int(member[name][k]) for name in columns), []).append(test)
    rows = []
    for cell in product(*(range(len(levels[name])) for name in columns)):
        ids = cells.get(cell, [])
        row: dict[str, object] = {}
        for name, k in zip(columns, cell, strict=True):
            row |= levels[name][k]
        rows.append(row | {"tests": len(ids), "ids": ", ".join(ids)})
    spans = [f"{end}_{name}" for name in columns for end in ("lowest", "highest")]
    return pd.DataFrame(rows, columns=[*columns, "tests", "ids", *spans])


test_matrix.__test__ = False  # pyright: ignore[reportFunctionMemberAccess]  # not pytest's


def _as_meant(
    name: str, measured: Float[np.ndarray, " n"], labels: Sequence[float | None]
) -> Float[np.ndarray, " n"]:
    """Labels of a condition where the measured value is near, else that."""
    label = np.array([np.nan if z is None else z for z in labels], dtype=np.float64)
    tolerance = np.maximum(RELATIVE[name] * np.abs(measured), ABSOLUTE[name])
    return np.where(np.abs(label - measured) <= tolerance, label, measured)


def find_levels(
    values: Float[np.ndarray, " n"], relative: float, absolute: float, several: int = 1
) -> tuple[Float[np.ndarray, " level"], np.ndarray]:
    """Group values by gaps wider than a tolerance, and a chain of neighbours by narrower ones.

    A chain wider than the tolerance is cut where its steps are too wide for steps within a level,
    if all parts are then narrower than these: 20, 25 and 30 °C. Else its levels cannot be told,
    and it stays one.

    Args:
        values: [n], NaN where unknown.
        relative: Tolerance in parts of a value.
        absolute: Tolerance, of which the larger counts.
        several: Values on average in the parts of a chain; as many as there are parts may be drift.

    Returns:
        [level] median of each, ascending, NaN last if there is any; and [n] each value's level.
    """
    known = np.isfinite(values)
    order = np.argsort(values[known], kind="stable")
    ordered = values[known][order]
    tolerance = np.maximum(relative * np.abs(ordered), absolute)
    chains = np.flatnonzero(np.diff(ordered) > tolerance[1:]) + 1
    parts = [
        np.split(chain, _cuts(ordered[chain], tolerance[chain], several))
        for chain in np.split(np.arange(ordered.size), chains)
        if chain.size
    ]
    groups = [part for several in parts for part in several]
    levels = [float(np.median(ordered[group])) for group in groups]
    member = np.full(values.size, len(groups), dtype=np.int64)
    for k, group in enumerate(groups):
        member[np.flatnonzero(known)[order[group]]] = k
    if not np.all(known):
        levels.append(float("nan"))
    return np.array(levels), member


def _cuts(
    chain: Float[np.ndarray, " k"], tolerance: Float[np.ndarray, " k"], several: int
) -> Int[np.ndarray, " cut"]:
    """Places at which a chain of ascending values falls into levels; none where they are one."""
    steps = np.diff(chain)
    cuts = np.flatnonzero(steps > ALIKE * tolerance[1:]) + 1
    widest = max(float(np.ptp(part)) for part in np.split(chain, cuts))
    if chain[-1] - chain[0] <= tolerance[-1] or chain.size < several * (cuts.size + 1):
        return cuts[:0]
    return cuts if widest < steps[cuts - 1].min(initial=np.inf) else cuts[:0]


def is_one_setting(name: str, lowest: float, highest: float) -> bool:
    """Whether a level of a condition is no wider than its tolerance; so is one that is unknown."""
    return not highest - lowest > max(RELATIVE[name] * abs(highest), ABSOLUTE[name])
