"""Loops of the physical dampers beside the papers' models, fitted and extended by a diagnosis."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

DATASETS: Final = Path(__file__).resolve().parents[1] / "datasets"
SHOWN: Final = {
    "virtual-matrix-165": ("2.5mm_10Hz_0.4A", "12.5mm_1.5Hz_0.2A"),
    "virtual-sweep": ("10mm_8Hz_0.4A_15C", "5mm_4Hz_1A_75C"),
}
MEASURED, FITTED, EXTENDED = "0.7", "#D55E00", "#0072B2"
"""Colours that colour-blind readers tell apart (Okabe and Ito)."""


def loops_png(work: Path, datasets: Sequence[str]) -> bytes:
    """One row a dataset: two tests, over velocity and over displacement.

    Args:
        work: Folder with `<dataset>/fit/card.json` and, where it is there,
            `<dataset>/diagnosis/card.json`.
        datasets: Which.
    """
    from matplotlib.figure import Figure

    from sysid.report.figure import png

    figure = Figure(figsize=(16.0, 4.2 * len(datasets)), layout="constrained")
    grid = figure.subplots(len(datasets), 4, squeeze=False)
    for row, dataset in zip(grid, datasets, strict=True):
        curves = _curves(work / dataset, dataset)
        for k, (test, lines) in enumerate(curves.items()):
            for ax, place in ((row[2 * k], 0), (row[2 * k + 1], 1)):
                for label, colour, wide, *motion, force in lines:
                    ax.plot(motion[place], force, color=colour, linewidth=wide, label=label)
                ax.set_xlabel(("velocity / (m/s)", "displacement / mm")[place])
                ax.grid(alpha=0.3)
            row[2 * k].set_title(test, loc="left", fontsize=11)
        row[0].set_ylabel(f"{dataset}\nforce / N")
        row[0].legend(fontsize=8)
    return png(figure)


def _curves(folder: Path, dataset: str) -> dict[str, list[tuple]]:
    """Test → (label, colour, width, velocity, displacement, force)."""
    from sysid.cards.read import read_card
    from sysid.cards.verify import verify
    from sysid.cli.selection import select
    from sysid.data.campaign import load_campaign
    from sysid.models.simulate import simulate
    from sysid.motion.motion import loop_motion

    loops = select(load_campaign(DATASETS / dataset), (), ()).loops
    loops = loops.select(np.array([name in SHOWN[dataset] for name in loops.ids]))
    told = [("measured", MEASURED, 4.5, loops.force)]
    for name, label, colour in (
        ("fit", "the paper's model, fitted", FITTED),
        ("diagnosis", "extended by the diagnosis", EXTENDED),
    ):
        card = folder / name / "card.json"
        if card.is_file():
            damper = verify(read_card(card, check=False), where=str(card))
            told.append((label, colour, 1.4, np.asarray(simulate(damper, loop_motion(loops)))))
    return {
        test: [
            (label, colour, wide, loops.velocity[k], 1e3 * loops.displacement[k], force[k])
            for label, colour, wide, force in told
        ]
        for k, test in enumerate(loops.ids)
    }
