"""Loops as lines of an SVG that stands in the page: there before any script has run."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from sysid.report.page.look import MEASURED, Look, looks
from sysid.report.page.one_test import Traces

WIDTH, HEIGHT = 420, 320
LEFT, RIGHT, BOTTOM = 62, 12, 46
LEGEND_ROW: Final = 17
"""Height of a row of the legend; the plot begins below."""
VELOCITY: Final = "velocity / (m/s), compression positive"
DISPLACEMENT: Final = "displacement / mm, compression positive"
LETTER: Final = 7.6
"""Width of a letter of the legend, on the average."""
LONGEST: Final = 30
"""Letters of a name that the legend shows."""
TICKS: Final = 5
"""Most intervals of an axis."""
MARGIN: Final = 0.05
"""Of the range, free on either side."""


@dataclass(frozen=True)
class Tick:
    """A round number on an axis.

    Attributes:
        at: Where it stands, in the drawing's units.
        text: The number.
    """

    at: float
    text: str


@dataclass(frozen=True)
class Line:
    """A curve.

    Attributes:
        name: In the legend.
        path: Data of an SVG path.
        look: Colour, dash and width.
        left: Of its entry in the legend, in the drawing's units, as below.
        top: Likewise.
    """

    name: str
    path: str
    look: Look
    left: float
    top: float


@dataclass(frozen=True)
class LoopFigure:
    """Axes and curves, in units of 1/420 of the drawing's width.

    Attributes:
        lines: Curves, the lowest first.
        x_ticks: Of the horizontal axis.
        y_ticks: Of the vertical one.
        x_title: With unit.
        y_title: With unit.
        top: Upper end of the plot.
        x_zero: Where zero is on the horizontal axis.
        y_zero: And on the vertical one.
    """

    lines: tuple[Line, ...]
    x_ticks: tuple[Tick, ...]
    y_ticks: tuple[Tick, ...]
    x_title: str
    y_title: str
    top: float
    x_zero: float
    y_zero: float
    width: int = WIDTH
    height: int = HEIGHT
    left: int = LEFT
    right: int = WIDTH - RIGHT
    bottom: int = HEIGHT - BOTTOM


def loop_figures(
    traces: Traces, measured: str, models: Sequence[str]
) -> tuple[LoopFigure, LoopFigure]:
    """Force over velocity and over displacement of one test, measured and simulated.

    Args:
        traces: Of the test.
        measured: What the measured curve is.
        models: Names, one a curve of `traces.models`.
    """
    loop = traces.over == "phase"
    forces = (traces.force, *traces.models)
    told = (measured, *models[: len(traces.models)])
    styles = (MEASURED, *looks(len(models)))[: len(told)]
    kept = [k for k, f in enumerate(forces) if np.isfinite(f).all()]

    def over(x: np.ndarray, title: str) -> LoopFigure:
        return _figure(
            x, [forces[k] for k in kept], [told[k] for k in kept], [styles[k] for k in kept],
            title, closed=loop,
        )  # fmt: skip

    return (
        over(traces.velocity, VELOCITY),
        over(1e3 * traces.displacement, DISPLACEMENT),
    )


def round_numbers(low: float, high: float, most: int = TICKS) -> list[float]:
    """Multiples of 1, 2 or 5 times a power of ten within a range, in at most some intervals.

    Args:
        low: Lower end.
        high: Upper end, above it.
        most: Intervals.
    """
    rough = (high - low) / most
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(s * power for s in (1.0, 2.0, 5.0, 10.0) if s * power >= rough * (1 - 1e-9))
    return [
        step * k for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)
    ]


def _figure(
    x: np.ndarray,
    forces: Sequence[np.ndarray],
    names: Sequence[str],
    styles: Sequence[Look],
    x_title: str,
    *,
    closed: bool,
) -> LoopFigure:
    places, rows = _legend(names)
    top = 8.0 + LEGEND_ROW * rows
    x_low, x_high = _range([x])
    y_low, y_high = _range(forces)
    right, bottom = WIDTH - RIGHT, HEIGHT - BOTTOM

    def across(value: np.ndarray | float) -> np.ndarray:
        return LEFT + (np.asarray(value) - x_low) / (x_high - x_low) * (right - LEFT)

    def up(value: np.ndarray | float) -> np.ndarray:
        return bottom - (np.asarray(value) - y_low) / (y_high - y_low) * (bottom - top)

    return LoopFigure(
        lines=tuple(
            Line(_short(name), _path(across(x), up(force), closed), look, *place)
            for name, force, look, place in zip(names, forces, styles, places, strict=True)
        ),
        x_ticks=tuple(Tick(_rounded(across(z)), _text(z)) for z in round_numbers(x_low, x_high)),
        y_ticks=tuple(Tick(_rounded(up(z)), _text(z)) for z in round_numbers(y_low, y_high)),
        x_title=x_title, y_title="force / N", top=top,
        x_zero=_rounded(across(0.0)), y_zero=_rounded(up(0.0)),
    )  # fmt: skip


def _legend(names: Sequence[str]) -> tuple[list[tuple[float, float]], int]:
    """Left and top of each entry, from left to right in as many rows as it takes."""
    places, left, row = [], float(LEFT), 0
    for name in names:
        width = 34.0 + LETTER * len(_short(name))
        if left > LEFT and left + width > WIDTH:
            left, row = float(LEFT), row + 1
        places.append((_rounded(left), 12.0 + LEGEND_ROW * row))
        left += width
    return places, row + 1


def _range(values: Sequence[np.ndarray]) -> tuple[float, float]:
    """Of an axis: all values, zero, and a margin."""
    low = min((float(v.min()) for v in values), default=0.0)
    high = max((float(v.max()) for v in values), default=0.0)
    low, high = min(low, 0.0), max(high, 0.0)
    spread = (high - low) or 1.0
    return low - MARGIN * spread, high + MARGIN * spread


def _path(x: np.ndarray, y: np.ndarray, closed: bool) -> str:
    points = "L".join(f"{a:.1f} {b:.1f}" for a, b in zip(x.tolist(), y.tolist(), strict=True))
    return f"M{points}Z" if closed else f"M{points}"


def _short(name: str) -> str:
    """The end of a long name: cards are told apart by the folders that they lie in."""
    return name if len(name) <= LONGEST else "…" + name[1 - LONGEST :]


def _text(value: float) -> str:
    return f"{value + 0.0:.6g}".replace("-", "−") if abs(value) > 1e-12 else "0"


def _rounded(value: np.ndarray | float) -> float:
    return round(float(value), 1)
