"""Force over time, measured beside simulated, for tests that are no loops."""

import numpy as np
from matplotlib.axes import Axes

from sysid.data.record import Record
from sysid.report.figure import new_axes, new_figure, png


def plot_history(data: tuple[Record, np.ndarray], *, ax: Axes | None = None) -> Axes:
    """Measured and simulated force of a whole record.

    Args:
        data: Record, simulated force [n] N.
        ax: Where to draw.
    """
    record, force = data
    ax = new_axes(ax)
    ax.plot(record.time, record.force, color="black", linewidth=0.9, label="measured")
    ax.plot(record.time, force, color="tab:red", linewidth=0.9, label="simulated")
    ax.set_xlabel("time / s")
    ax.set_ylabel("force / N")
    ax.grid(alpha=0.3)
    ax.legend()
    return ax


def history_png(record: Record, force: np.ndarray, title: str) -> bytes:
    """The same as PNG.

    Args:
        record: The test.
        force: [n] N, simulated.
        title: Above it.
    """
    figure, (ax,) = new_figure(1)
    plot_history((record, force), ax=ax)
    figure.suptitle(title)
    return png(figure)
