"""Measured loops beside the base model and the extended model, in free run."""

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes

from sysid.diagnosis.result import Diagnosis
from sysid.diagnosis.words import EFFECT_WORDS, listed
from sysid.report.figure import closed, new_axes, png

MEASURED, BEFORE, AFTER = "0.7", "#D55E00", "#0072B2"
"""Colours that colour-blind readers tell apart (Okabe and Ito); dashes tell them apart in grey."""


def plot_before_after(
    diagnosis: Diagnosis, test: int, over: str = "velocity", *, ax: Axes | None = None
) -> Axes:
    """One test: measured, base model and extended model.

    Args:
        diagnosis: The diagnosis.
        test: Index of the test.
        over: "velocity" or "displacement".
        ax: Where to draw.
    """
    ax = new_axes(ax)
    loops = diagnosis.loops
    x = loops.velocity[test] if over == "velocity" else 1e3 * loops.displacement[test]
    ax.plot(
        closed(x),
        closed(loops.force[test]),
        color=MEASURED,
        linewidth=4.5,
        label=measured_words(diagnosis),
    )
    before = closed(diagnosis.simulated_before[test])
    ax.plot(
        closed(x), before, color=BEFORE, linewidth=1.4, linestyle=(0, (5, 2)), label="base model"
    )
    if extended(diagnosis):
        after = closed(diagnosis.simulated_after[test])
        ax.plot(closed(x), after, color=AFTER, linewidth=1.4, label="extended model")
    unit = "velocity / (m/s)" if over == "velocity" else "displacement from the centre / mm"
    ax.set_xlabel(f"{unit}, compression positive")
    ax.set_ylabel("force / N")
    ax.grid(alpha=0.3)
    ax.legend(fontsize=9)
    return ax


def before_after_png(diagnosis: Diagnosis) -> bytes:
    """The test that the base model gets most wrong, and the median one, as PNG.

    Worst and median are by the base model's RMSE/max|F|.
    """
    from matplotlib.figure import Figure

    before = errors(diagnosis, diagnosis.simulated_before)
    after = errors(diagnosis, diagnosis.simulated_after)
    order = np.argsort(-before, kind="stable")
    rows = {"Worst test": int(order[0]), "Median test": int(order[order.size // 2])}
    figure = Figure(figsize=(13.0, 9.0), layout="constrained")
    grid = figure.subplots(2, 2, squeeze=False)
    for row, (title, k) in zip(grid, rows.items(), strict=True):
        plot_before_after(diagnosis, k, "velocity", ax=row[0])
        plot_before_after(diagnosis, k, "displacement", ax=row[1])
        change = f"{before[k]:.1%}" + (f" → {after[k]:.1%}" if extended(diagnosis) else "")
        row[0].set_title(f"{title}: {diagnosis.loops.ids[k]}", loc="left", fontsize=11)
        row[1].set_title(f"RMSE {change} of max|F|", loc="right", fontsize=11)
    return png(figure)


def extended(diagnosis: Diagnosis) -> bool:
    """Something was added to the base model."""
    return bool(diagnosis.damper.effects)


def errors(
    diagnosis: Diagnosis, simulated: Float[np.ndarray, "loop phase"]
) -> Float[np.ndarray, " loop"]:
    """RMSE/max|F| of each test in free run, [L]."""
    force = diagnosis.loops.force
    rmse = np.sqrt(np.mean((simulated - force) ** 2, axis=1))
    return rmse / np.abs(force).max(axis=1)


def measured_words(diagnosis: Diagnosis) -> str:
    """What the loops are: as measured, or without what the cycles showed."""
    ids = [cause.effect.facts.id for cause in diagnosis.causes if cause.from_cycles]
    taken = listed([EFFECT_WORDS[id] for id in ids])
    return f"measured, less {taken}" if taken else "measured"
