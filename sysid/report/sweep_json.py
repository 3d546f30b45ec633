"""What a fit of a sweep over temperature tells beside its parameters, for scripts."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from sysid.identification.recipes_beside import RecipesBeside
from sysid.identification.statics import Statics
from sysid.identification.straight_lines.levels import amperes, by_current
from sysid.identification.straight_lines.lines import Line
from sysid.identification.straight_lines.recipes import TemperatureLine
from sysid.identification.straight_lines.stage import Stage
from sysid.identification.straight_lines.words import sentences
from sysid.identification.temperature_laws import TemperatureLaws


def statics_json(statics: Statics) -> dict[str, Any]:
    """Static forces beside the model, N, and the error without them."""
    return {
        "mean_N": float(statics.value.mean()),
        "line": None if statics.line is None else _line(statics.line),
        "mean_nrmse_without": statics.mean_nrmse,
        "tests": dict(zip(statics.ids, statics.value.tolist(), strict=True)),
    }


def straight_lines_json(beside: RecipesBeside) -> dict[str, Any]:
    """Lines of the recipes at each current, and their bias on the loops of the fit."""
    found, bias = beside.found, beside.bias
    rows = [
        *_rows(found.viscosity, found.viscosity_lines, bias.viscosity),
        *_rows(found.yield_force, found.yield_lines, bias.yield_force),
        *_rows(found.stiffness, found.stiffness_lines, bias.stiffness),
    ]
    offset = found.offset_line
    return {
        "lines": rows,
        "offset": None if offset is None else {"unit": "N", **_line(offset.line)},
        "sentences": list(sentences(found, beside.unbiased)),
    }


def laws_json(laws: TemperatureLaws) -> dict[str, Any]:
    """Straight lines in temperature against each law bent, by error on blocks left out."""
    return {
        "straight_held_out_nrmse": laws.error,
        "blocks": laws.blocks,
        "level": laws.level,
        "bent": [
            {
                "symbol": law.symbol, "bend": law.bend, "change_half_way": law.middle,
                "held_out_nrmse": law.error,
                "gain": {"value": law.gain, "low": law.low, "high": law.high},
                "curved": law.curved,
            }
            for law in laws.laws
        ],
    }  # fmt: skip


def _rows(
    stage: Stage, lines: Sequence[TemperatureLine], bias: dict[str, float]
) -> list[dict[str, Any]]:
    rows, levels = [], by_current(stage.readings)
    for told in lines:
        near = min(levels, key=lambda z: abs(z[0] - told.current))[1]
        known = [bias[r.id] for r in near if r.id in bias]
        cold, hot = told.line.ends
        change = told.line.change(cold, hot)
        rows.append(
            {
                "symbol": stage.symbol,
                "unit": stage.unit,
                "current_A": float(amperes(told.current)),
                **_line(told.line),
                "change": {
                    "from_degC": cold, "to_degC": hot, "percent": _finite(change.percent),
                    "low": _finite(change.low), "high": _finite(change.high),
                },
                "bias": {"low": min(known), "mean": float(np.mean(known)), "high": max(known)}
                if known
                else None,
            }
        )  # fmt: skip
    return rows


def _line(line: Line) -> dict[str, Any]:
    (low, high), (flat, steep) = line.intervals
    return {
        "intercept": {"value": line.intercept, "low": low, "high": high},
        "slope": {"value": line.slope, "low": flat, "high": steep},
        "scatter": line.scatter,
        "tests": int(line.value.size),
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
