"""Run the code cells of a notebook one after the other, and tell of the figures they drew.

    python run_notebook.py NOTEBOOK

The last line printed is JSON: for each figure how many axes, how many of these have a labelled
axis, and how many things are drawn.
"""

import json
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.figure import Figure


def drawn(figure: Figure) -> tuple[int, int, int]:
    """Axes, labelled axes, lines and images and areas."""
    figure.canvas.draw()
    labelled = sum(bool(ax.get_xlabel() or ax.get_ylabel()) for ax in figure.axes)
    things = sum(len(ax.lines) + len(ax.images) + len(ax.collections) for ax in figure.axes)
    return len(figure.axes), labelled, things


def main(path: Path) -> None:
    """As Jupyter does it: all cells share their names, figures are shown after their cell."""
    names: dict[str, object] = {"__name__": "__main__"}
    figures = []
    for number, cell in enumerate(json.loads(path.read_text(encoding="utf-8"))["cells"]):
        if cell["cell_type"] != "code":
            continue
        exec(compile("".join(cell["source"]), f"{path.name}, cell {number}", "exec"), names)
        figures += [drawn(plt.figure(k)) for k in plt.get_fignums()]
        plt.close("all")
    print(json.dumps(figures))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
