"""A few loops that differ in one thing, each with its name, alone or with a simulation on top."""

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes

from sysid.data.loops import Loops
from sysid.report.figure import closed, new_axes


def plot_family(
    data: tuple[Loops, Sequence[str], np.ndarray | None],
    *,
    over: str = "velocity",
    ax: Axes | None = None,
) -> Axes:
    """Measured loops, one colour and one entry of the legend each; simulated ones black, dashed.

    Args:
        data: L loops in the order in which they are named; L names; simulated force [L, J] N, or
            None.
        over: What force is drawn over, `velocity` or `displacement`.
        ax: Where to draw.
    """
    loops, names, simulated = data
    ax = new_axes(ax)
    x = loops.velocity if over == "velocity" else 1e3 * loops.displacement
    colours = colormaps["viridis"](np.linspace(0.0, 0.9, max(len(names), 2)))
    for k, name in enumerate(names):
        ax.plot(closed(x[k]), closed(loops.force[k]), color=colours[k], linewidth=1.6, label=name)
    if simulated is not None:
        for k in range(len(names)):
            label = "model" if k == 0 else None
            force = closed(simulated[k])
            ax.plot(closed(x[k]), force, color="black", linewidth=0.9, dashes=(4, 2), label=label)
    name = "velocity / (m/s)" if over == "velocity" else "displacement from the centre / mm"
    ax.set_xlabel(f"{name}, compression positive")
    ax.set_ylabel("force / N")
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8)
    return ax
