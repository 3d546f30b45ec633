"""How large the error of every test is, against how fast it was."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from sysid.data.loops import Loops
from sysid.identification.result import TestError
from sysid.report.before_after_plot import AFTER, BEFORE
from sysid.report.figure import new_axes


def plot_errors(data: tuple[Loops, Sequence[TestError]], *, ax: Axes | None = None) -> Axes:
    """RMSE/max|F| of fitted and held-out tests over peak velocity, beside mean cycles' noise.

    The mean cycle is what the model is compared with.

    Args:
        data: L loops; errors of tests, those of the loops among them.
        ax: Where to draw.
    """
    loops, tests = data
    ax = new_axes(ax)
    by_id = {test.id: test for test in tests}
    own = [by_id[name] for name in loops.ids]
    error = 100.0 * np.array([test.nrmse for test in own])
    held = np.array([test.held_out for test in own], dtype=bool)
    peak = np.abs(loops.force).max(axis=1)
    floor = 100.0 * loops.mean_cycle_noise / peak
    speed = loops.peak_velocity
    ax.plot(speed, floor, "_", color="black", markersize=9, label="noise of the mean cycle")
    ax.plot(speed[~held], error[~held], "o", color=AFTER, markersize=5, label="fitted")
    if held.any():
        ax.plot(speed[held], error[held], "D", color=BEFORE, markersize=5, label="held out")
    ax.set_ylim(0.0, 1.15 * float(np.nanmax(np.append(error, floor))))
    ax.set_xlabel("peak velocity of the test / (m/s)")
    ax.set_ylabel("RMSE / % of max|F|")
    ax.grid(alpha=0.3)
    ax.legend(fontsize=9)
    return ax
