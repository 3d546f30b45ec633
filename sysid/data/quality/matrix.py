"""The test matrix: amplitude × frequency × current × temperature, there or missing."""

from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops

if TYPE_CHECKING:
    import pandas as pd

RELATIVE = {"amplitude_m": 0.05, "frequency_Hz": 0.05, "current_A": 0.05, "temperature_degC": 0.0}
ABSOLUTE = {"amplitude_m": 0.0, "frequency_Hz": 0.0, "current_A": 0.02, "temperature_degC": 5.0}
"""Neighbours closer than this (relative to the larger, or absolute) are one level."""


def test_matrix(loops: Loops) -> "pd.DataFrame":
    """All combinations of the levels that were measured, with the tests at each.

    Returns:
        Columns ``amplitude_m, frequency_Hz, current_A, temperature_degC`` (levels: medians of
        what was measured; NaN is one level), ``tests`` (number) and ``ids``; ``tests`` is 0 where
        the combination is missing.
    """
    import pandas as pd

    columns = {
        "amplitude_m": loops.amplitude,
        "frequency_Hz": loops.frequency,
        "current_A": loops.current,
        "temperature_degC": loops.temperature,
    }
    levels, member = {}, {}
    for name, values in columns.items():
        levels[name], member[name] = find_levels(values, RELATIVE[name], ABSOLUTE[name])
    cells: dict[tuple[int, ...], list[str]] = {}
    for k, test in enumerate(loops.ids):
        cells.setdefault(tuple(int(member[name][k]) for name in columns), []).append(test)
    rows = []
    for cell in product(*(range(levels[name].size) for name in columns)):
        ids = cells.get(cell, [])
        row = {name: levels[name][k] for name, k in zip(columns, cell, strict=True)}
        rows.append(row | {"tests": len(ids), "ids": ", ".join(ids)})
    return pd.DataFrame(rows, columns=[*columns, "tests", "ids"])


test_matrix.__test__ = False  # pyright: ignore[reportFunctionMemberAccess]  # not pytest's


def find_levels(
    values: Float[np.ndarray, " n"], relative: float, absolute: float
) -> tuple[Float[np.ndarray, " level"], np.ndarray]:
    """Group values by gaps wider than a tolerance.

    Returns:
        [level] median of each, ascending, NaN last if there is any; and [n] each value's level.
    """
    known = np.isfinite(values)
    order = np.argsort(values[known], kind="stable")
    ordered = values[known][order]
    apart = np.diff(ordered) > np.maximum(relative * np.abs(ordered[1:]), absolute)
    group = np.concatenate([[0], np.cumsum(apart)]).astype(np.int64)[: ordered.size]
    count = int(group[-1]) + 1 if ordered.size else 0
    levels = [float(np.median(ordered[group == g])) for g in range(count)]
    member = np.full(values.size, count, dtype=np.int64)
    member[np.flatnonzero(known)[order]] = group
    if not np.all(known):
        levels.append(float("nan"))
    return np.array(levels), member
