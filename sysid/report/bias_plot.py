"""By how much the straight-line recipes are wrong on perfect loops, against temperature."""

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes

from sysid.data.loops import Loops
from sysid.identification.straight_lines.bias import Bias
from sysid.identification.straight_lines.levels import amperes, current_levels
from sysid.report.figure import new_axes

SYMBOLS = {"viscosity": "C_post", "yield_force": "F_y", "stiffness": "k"}
"""Field of `Bias` → symbol."""


def plot_bias(data: tuple[Loops, Bias, str], *, ax: Axes | None = None) -> Axes:
    """Recipe over truth minus one, test by test, a colour and a line for each current.

    Args:
        data: Loops; bias on them; which of it, `viscosity`, `yield_force` or `stiffness`.
        ax: Where to draw.
    """
    loops, bias, quantity = data
    ax = new_axes(ax)
    of_test: dict[str, float] = getattr(bias, quantity)
    tests = np.array([k for k, name in enumerate(loops.ids) if name in of_test], dtype=int)
    values = 100.0 * np.array([of_test[loops.ids[k]] for k in tests])
    order = np.argsort(loops.temperature[tests])
    tests, values = tests[order], values[order]
    current = loops.current[tests]
    levels = current_levels(current)
    colours = colormaps["viridis"](np.linspace(0.0, 0.9, max(len(levels), 2)))
    for (level, here), colour in zip(levels, colours, strict=False):
        ax.plot(
            loops.temperature[tests[here]], values[here], ".-", color=colour, linewidth=0.8,
            label=f"{amperes(level)} A",
        )  # fmt: skip
    ax.axhline(0.0, color="black", linewidth=0.8)
    ax.set_xlabel("temperature / °C")
    ax.set_ylabel(f"{SYMBOLS[quantity]}: bias of the recipe / %")
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8)
    return ax
