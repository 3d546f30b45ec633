"""Drawing without a display: figures become PNG bytes, never windows."""

import io

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure


def new_axes(ax: Axes | None) -> Axes:
    """The axes to draw on; a figure of its own where none are given."""
    return Figure(figsize=(7.0, 5.0), layout="constrained").subplots() if ax is None else ax


def new_figure(
    columns: int, *, width: float = 6.5, height: float = 5.0
) -> tuple[Figure, list[Axes]]:
    """A figure with panels side by side."""
    figure = Figure(figsize=(width * columns, height), layout="constrained")
    return figure, list(figure.subplots(1, columns, squeeze=False)[0])


def png(figure: Figure, dpi: int = 110) -> bytes:
    """A figure as PNG; no time of making is written into it."""
    FigureCanvasAgg(figure)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": "sysid"})
    return buffer.getvalue()


def level_of(current: float) -> str:
    """A measured current as people set it, A: to the milliampere, and never minus zero."""
    return f"{round(float(current), 3) + 0.0:.3g}"
