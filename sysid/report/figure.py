"""Drawing without a display: figures become PNG bytes, never windows."""

import io
import warnings
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

TICKS: Final = r"\mathdefault"
"""What labels of powers of ten hold, and no name that people give."""


def new_axes(ax: Axes | None) -> Axes:
    """The axes to draw on; a figure of its own where none are given."""
    return Figure(figsize=(7.0, 5.0), layout="constrained").subplots() if ax is None else ax


def new_figure(
    columns: int, *, width: float = 6.5, height: float = 5.0
) -> tuple[Figure, list[Axes]]:
    """A figure with panels side by side."""
    figure = Figure(figsize=(width * columns, height), layout="constrained")
    return figure, list(figure.subplots(1, columns, squeeze=False)[0])


def closed(values: np.ndarray) -> np.ndarray:
    """A loop of [n] values with the first one again at its end."""
    return np.append(values, values[:1])


def png(figure: Figure, dpi: int = 110) -> bytes:
    """A figure as PNG; no time of making is written into it.

    Names of tests and campaigns are taken as they are: a dollar sign begins no formula, and a
    letter that the font lacks is drawn as a box without a word.  Ticks keep theirs: powers of ten
    are written when the figure is drawn, which is later.
    """
    FigureCanvasAgg(figure)
    for text in figure.findobj(Text):
        if isinstance(text, Text) and "$" in text.get_text() and TICKS not in text.get_text():
            text.set_parse_math(False)
    buffer = io.BytesIO()
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from", category=UserWarning)
        figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": "sysid"})
    return buffer.getvalue()
