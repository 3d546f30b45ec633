"""Where a simulation is wrong: every test a row, phase along it, sign and size as colour."""

from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from sysid.data.loops import Loops
from sysid.diagnosis.lack_of_fit import LackOfFit
from sysid.diagnosis.parity import PARITIES
from sysid.identification.straight_lines.levels import amperes, current_levels, excitations
from sysid.report.loop_plots import APART
from sysid.report.page.symmetry import MEANING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LINE = 22
"""Letters of a line beside the bars."""


def plot_residual_map(loops: Loops, found: LackOfFit, *, ax: "Axes | None" = None) -> "Axes":
    """Residual of every test over phase, % of its peak force; red: measured exceeds simulated.

    Rows are ordered by current, then peak velocity, in a sweep then from cold to warm; the phase
    axis is marked where the motion reverses and where it is fastest.

    Args:
        loops: L tests.
        found: Their lack of fit.
        ax: Axes to draw on; new ones if None.

    Returns:
        The axes.
    """
    import matplotlib.pyplot as plt

    if ax is None:
        ax = plt.subplots(figsize=(9, 0.18 * len(loops.ids) + 2))[1]
    groups = _groups(loops)
    order = np.concatenate(groups)
    warm = any(np.ptp(loops.temperature[group]) >= APART for group in groups)
    peak = np.abs(loops.force).max(axis=1, keepdims=True)
    image = 100.0 * (found.residual / peak)[order]
    limit = float(np.quantile(np.abs(image), 0.99)) or 1.0
    shown = ax.imshow(
        image, aspect="auto", cmap="RdBu_r", vmin=-limit, vmax=limit, interpolation="nearest",
        extent=(0.0, 360.0, len(order) - 0.5, -0.5),
    )  # fmt: skip
    ax.set_xticks([0, 90, 180, 270, 360])
    ax.set_xticklabels(
        ["0°\nfastest in", "90°\nreversal", "180°\nfastest out", "270°\nreversal", "360°"]
    )
    ax.set_yticks(range(len(order)))
    ax.set_yticklabels([_row_name(loops, k, warm=warm) for k in order], fontsize=6)
    ax.set_xlabel("phase of the displacement")
    ax.figure.colorbar(shown, ax=ax, label="measured − simulated / % of max|F|")
    return ax


def plot_parity(found: LackOfFit, *, ax: "Axes | None" = None) -> "Axes":
    """Share of the residual's energy in each parity, with what such a part usually is.

    Args:
        found: Lack of fit of a campaign.
        ax: Axes to draw on; new ones if None.

    Returns:
        The axes.
    """
    import matplotlib.pyplot as plt

    if ax is None:
        ax = plt.subplots(figsize=(5, 3))[1]
    shares = [100.0 * found.parity[p] for p in PARITIES]
    bars = ax.barh(range(4), shares, color="tab:blue")
    ax.bar_label(bars, fmt="%.0f %%", padding=3)
    ax.set_yticks(range(4))
    ax.set_yticklabels([fill(f"{p}: {MEANING[p]}", _LINE) for p in PARITIES], fontsize=8)
    ax.invert_yaxis()
    ax.set_xlim(0.0, 115.0)
    ax.set_xlabel("share of the residual's energy / %")
    return ax


def _groups(loops: Loops) -> list[np.ndarray]:
    """Places of the tests of each current and excitation, by both and from cold to warm."""
    known = np.isfinite(loops.current)
    levels = current_levels(loops.current[known]) if known.any() else []
    every = [*(np.flatnonzero(known)[level] for _, level in levels), np.flatnonzero(~known)]
    groups = [np.intersect1d(level, e.tests) for level in every for e in excitations(loops)]
    return [g[np.argsort(loops.temperature[g], kind="stable")] for g in groups if g.size]


def _row_name(loops: Loops, k: int, *, warm: bool) -> str:
    amplitude, frequency = 1e3 * loops.amplitude[k], loops.frequency[k]
    name = f"{amperes(loops.current[k])} A  {amplitude:.3g} mm  {frequency:.3g} Hz"
    return f"{name}  {loops.temperature[k]:.0f} °C" if warm else name
