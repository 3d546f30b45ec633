"""Makes the pictures of README and documentation from a demonstration: nothing is drawn by hand.

    python docs/build_pictures.py                    runs `sysid demo` (a minute), then draws both
    python docs/build_pictures.py --from DIR         from a demonstration that is there

docs/images/story.svg: what was measured, what the model made of it before and after, the cause that
was named, what had been hidden, and the error beside the noise.  docs/images/report.png: the first
screen of report.html in a headless Chromium; left out, with a sentence, where there is none.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import matplotlib as mpl
import numpy as np
from jaxtyping import Float

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from sysid.diagnosis.result import Quantity
from sysid.diagnosis.words import EFFECT_WORDS, amount, percent, size_words
from sysid.report.page.look import AFTER, BEFORE, MEASURED, Look
from sysid.report.page.packed import Packed, unpack
from sysid.rig.truth import SEAL_FILE, open_seal
from tests.report.browser import Tab, find_browser, in_browser

ROOT: Final = Path(__file__).resolve().parents[1]
IMAGES: Final = ROOT / "docs" / "images"
STORY: Final = IMAGES / "story.svg"
SCREEN: Final = IMAGES / "report.png"
LARGEST: Final = 300_000
"""Bytes of a picture."""
PAPER, INK, SOFT = "#ffffff", "#1b1f24", "#5a6370"
"""A card of its own colour: the same on a light page and on a dark one."""
SIZE: Final = (10.0, 4.1)
"""Inches; at 83 pixels an inch as wide as GitHub shows a picture."""
SCREEN_SIZE: Final = (1280, 800)


@dataclass(frozen=True)
class Story:
    """What the picture tells.

    Attributes:
        test: Conditions of the test that is shown, in words.
        velocity: [n] m/s.
        measured: [n] N.
        before: [n] N, base model.
        after: [n] N, extended model.
        cause: Named, with its size.
        hidden: What the seal said, with its size.
        confidence: Of the name, 0 … 1.
        errors: RMSE/max|F| on tests left out: before, after, noise of the mean cycle.
        tests: Their number.
    """

    test: str
    velocity: Float[np.ndarray, " n"]
    measured: Float[np.ndarray, " n"]
    before: Float[np.ndarray, " n"]
    after: Float[np.ndarray, " n"]
    cause: str
    hidden: str
    confidence: float
    errors: tuple[float, float, float]
    tests: int


def read_story(folder: Path) -> Story:
    """Read a demonstration.

    Args:
        folder: That `sysid demo` wrote.
    """
    diagnosis = folder / "diagnosis"
    page = (diagnosis / "report.html").read_text(encoding="utf-8")
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page)
    if found is None:
        raise SystemExit(f"{diagnosis / 'report.html'} has no data: run `sysid demo` again")
    data = json.loads(found[1])
    summary = json.loads((diagnosis / "diagnosis.json").read_text(encoding="utf-8"))
    if not summary["causes"] or summary["gain"] is None:
        raise SystemExit("nothing was named in this demonstration: take another --seed")

    worst = data["tests"][data["worst"]]
    velocity, measured, before, after = (
        unpack(Packed(*z)) for z in (worst["v"], worst["f"], *worst["m"])
    )
    label = data["labels"][data["worst"]]

    (cause,) = summary["causes"]
    symbol, size = next(iter(cause["parameters"].items()))
    hidden = dict(open_seal(folder / "tests" / SEAL_FILE).effects[0])
    gain = summary["gain"]
    return Story(
        test=", ".join(label.split("; ")[1].split(", ")[:3]),
        velocity=velocity, measured=measured, before=before, after=after,
        cause=f"{EFFECT_WORDS[cause['id']]}, {_size(symbol, size)}",
        hidden=size_words(symbol, size["unit"], float(hidden["quantities"]["size"])),
        confidence=cause["confidence"],
        errors=(
            gain["held_out_nrmse_before"], gain["held_out_nrmse_after"], gain["noise_floor_nrmse"]
        ),
        tests=len(gain["tests"]),
    )  # fmt: skip


def _size(symbol: str, told: dict[str, Any]) -> str:
    return amount(
        Quantity(
            symbol=symbol, name=told["name"], unit=told["unit"], value=told["value"], sd=told["sd"],
            low=told["low"], high=told["high"], level=told["level"], identified=told["identified"],
        )
    )  # fmt: skip


def draw_story(story: Story, path: Path) -> None:
    """Draw it as SVG.

    Args:
        story: What is told.
        path: Where to.
    """
    mpl.use("svg")
    from matplotlib.figure import Figure

    style: dict[Any, Any] = {
        "svg.hashsalt": "sysid", "svg.fonttype": "path", "font.size": 10.5, "axes.edgecolor": SOFT,
        "axes.labelcolor": INK, "text.color": INK, "xtick.color": SOFT, "ytick.color": SOFT,
    }  # fmt: skip
    with mpl.rc_context(style):
        figure = Figure(figsize=SIZE, facecolor=PAPER)
        grid = figure.add_gridspec(
            1, 3, left=0.078, right=0.985, top=0.78, bottom=0.15, wspace=0.25,
            width_ratios=(1.0, 1.0, 0.78),
        )  # fmt: skip
        first = figure.add_subplot(grid[0])
        second = figure.add_subplot(grid[1], sharex=first, sharey=first)
        bars = figure.add_subplot(grid[2])
        _loop(first, story, story.before, BEFORE, "model fitted to all tests")
        _loop(second, story, story.after, AFTER, "model with the cause")
        first.set_ylabel("force / N")
        before, after, floor = story.errors
        _title(first, "1", "Where a model is wrong", f"{story.test}; one of {story.tests} tests")
        _title(second, "2", "Why, and by how much", f"{story.cause}")
        second.text(
            0.97, 0.05, f"hidden in these tests:\n{story.hidden}", transform=second.transAxes,
            ha="right", va="bottom", fontsize=9.5, color=SOFT, linespacing=1.35,
        )  # fmt: skip
        _bars(bars, before, after, floor)
        _title(bars, "3", "What it is worth", "error on tests left out")
        figure.savefig(path, format="svg", facecolor=PAPER, metadata={"Date": None})


def _loop(ax: Any, story: Story, model: np.ndarray, look: Look, name: str) -> None:
    def closed(values: np.ndarray) -> np.ndarray:
        return np.append(values, values[0])

    v = closed(story.velocity)
    ax.axhline(0, color="#d5dae0", linewidth=0.8, zorder=0)
    ax.axvline(0, color="#d5dae0", linewidth=0.8, zorder=0)
    ax.plot(v, closed(story.measured), color=MEASURED.colour, linewidth=5.0, label="measured")
    ax.plot(v, closed(model), color=look.colour, linewidth=1.9, label=name,
            linestyle="--" if look.dash == "dash" else "-")  # fmt: skip
    ax.set_xlabel("velocity / (m/s)")
    ax.set_ylim(*(np.array([-1.12, 1.5]) * np.abs(story.measured).max()))
    ax.legend(loc="upper left", frameon=False, fontsize=9.5, handlelength=1.8, borderaxespad=0.2)
    ax.spines[["top", "right"]].set_visible(False)


def _title(ax: Any, number: str, words: str, below: str) -> None:
    ax.text(0.0, 1.165, f"{number}  {words}", transform=ax.transAxes, fontsize=13, weight="bold")
    ax.text(0.0, 1.06, below, transform=ax.transAxes, fontsize=10, color=SOFT)


def _bars(ax: Any, before: float, after: float, floor: float) -> None:
    shown = (("before", before, BEFORE.colour, "//"), ("after", after, AFTER.colour, ""),
             ("noise of the mean cycle", floor, "#6b7280", ""))  # fmt: skip
    for k, (name, value, colour, hatch) in enumerate(shown):
        ax.barh(
            k, 100 * value, height=0.46, color=colour, hatch=hatch, edgecolor=PAPER, linewidth=0
        )
        ax.text(0.0, k - 0.32, name, va="bottom", fontsize=10, color=SOFT)
        ax.text(100 * value, k, f"  {percent(value)}", va="center", fontsize=12, weight="bold")
    ax.set_xlim(0.0, 150 * before)
    ax.set_ylim(2.5, -0.72)
    ax.set_axis_off()
    ax.text(0.0, 2.62, "RMSE, % of the peak force", va="top", fontsize=9.5, color=SOFT)


def photograph(page: Path, path: Path) -> bool:
    """Take a picture of a page's first screen; False where there is no browser.

    Args:
        page: report.html.
        path: Where to.
    """
    if find_browser() is None:
        return False

    async def visit(tab: Tab) -> None:
        await tab.size(*SCREEN_SIZE)
        await tab.until("document.documentElement?.dataset.ready")
        await tab.picture(path)

    in_browser(page, visit)
    return True


def main() -> int:
    """Make both."""
    parser = argparse.ArgumentParser(description="Make docs/images/story.svg and report.png.")
    parser.add_argument("--from", dest="folder", type=Path, help="what `sysid demo` wrote")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = asked.folder
        if folder is None:
            folder = Path(scratch) / "demo"
            program = Path(sys.executable).with_name("sysid")
            subprocess.run([program, "demo", "-o", folder, "--quiet"], check=True)
        IMAGES.mkdir(parents=True, exist_ok=True)
        made = [STORY]
        draw_story(read_story(folder), STORY)
        if photograph(folder / "diagnosis" / "report.html", SCREEN):
            made.append(SCREEN)
        else:
            print("No Chromium here (SYSID_CHROMIUM names one): report.png is left as it was.")
    for path in made:
        size = path.stat().st_size
        print(f"{path.relative_to(ROOT)}: {size / 1e3:.0f} kB")
        if size > LARGEST:
            print(f"{path.name} is larger than {LARGEST / 1e3:g} kB", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
