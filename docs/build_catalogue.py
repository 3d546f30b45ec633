"""Writes the catalogue of effects, a page and a figure each, from what the effects declare.

    python docs/build_catalogue.py            page and figures
    python docs/build_catalogue.py --page     the page alone (no simulation)

The figures are simulations of one test, 12.5 mm, 2.5 Hz, 0.2 A, of W11's damper (Table 2, 0.5 to
5 Hz), the recorded force with the effect at its nominal size and without it.
"""

import argparse
import inspect
import re
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from sysid.effects.base import AbstractEffect
from sysid.effects.registry import EFFECTS, choices, make
from sysid.parameters import ParamSpec, specs

HERE: Final = Path(__file__).resolve().parent
PAGE: Final = HERE / "catalogue.md"
FIGURES: Final = HERE / "images" / "effects"

AMPLITUDE, FREQUENCY, CURRENT, TEMPERATURE = 12.5e-3, 2.5, 0.2, 50.0
POINTS: Final = 360
EVERY: Final = 3
"""Of the points is drawn."""
NOTHING: Final = 1e-6
"""A change of the force by less than this part of its largest is none."""

STAGES: Final[dict[str, str]] = {
    "drive": "between the commanded and the effective current",
    "motion": "between the recorded motion and that at the valve",
    "law": "how the valve's force depends on frequency, temperature, speed or force",
    "force": "beside the valve, a force that is added",
    "channel": "between the true and the recorded force",
}
FOUND_FROM: Final[dict[str, str]] = {
    "loops": "steady loops",
    "history": "run order, or the cycles of a test",
    "check": "the recorded channels, not the loops",
    "invisible": "no tests at constant current, since the model's own parameters imitate it",
}
PARITIES: Final[dict[str, str]] = {
    "OD": "dissipative, odd: turns its sign with the motion, like friction",
    "OC": "conservative, odd: like a spring or a mass",
    "ED": "dissipative, even: the same sign in compression and rebound",
    "EC": "conservative, even: like an offset or a curved spring",
}

HEAD: Final = """\
# Catalogue of effects

<!-- Written by docs/build_catalogue.py from what the effects declare. Do not edit. -->

What real tests contain and base models do not. {named} of them `sysid diagnose` can name;
{invisible} are listed as invisible, since no test at constant current shows them; {check} belong to
the recording and are left to `sysid check`, which reports quantisation, a late velocity, hum and
distortion of the motion. An effect stands at one place of the signal path from the commanded
current and the recorded motion to the recorded force; with its size at zero it is exactly nothing.
Symmetry, growth and identity at zero are checked by `tests/contracts/test_effects.py`.

How to read an entry:

- *size* is the parameter that is zero where the effect is absent; *nominal* is a realistic value,
  *realistic* the range that real dampers and rigs show, *allowed* what a card may hold. SI units;
  temperatures are counted from 40 °C.
- *symmetry* says how the force that the effect adds behaves when motion is mirrored (odd, even) or
  time runs backwards (dissipative, conservative), and what share of its energy that part has.
- *growth* is the RMS of the added force as a power of amplitude A, frequency f and current i.
- *looks like* lists effects that resemble it, and *told apart by* a test that shows which it is.
- the figure is one simulated test, 12.5 mm, 2.5 Hz, 0.2 A at 50 °C, of W11's damper (Table 2,
  0.5 to 5 Hz): left the loop of recorded force against velocity without (grey) and with the effect
  at nominal size (blue), right the difference over the phase of x = A sin φ. Where it needs history
  the test is the last of its campaign, in its first cycle, and the current was lowered before it.
"""


@dataclass(frozen=True)
class Signature:
    """What an effect does to one loop.

    Attributes:
        velocity: [J] m/s.
        without: [J] recorded force of the damper alone, N.
        with_effect: [J] with the effect, N.
    """

    velocity: NDArray[np.float64]
    without: NDArray[np.float64]
    with_effect: NDArray[np.float64]

    @property
    def added(self) -> NDArray[np.float64]:
        """The difference, N."""
        return self.with_effect - self.without

    @property
    def rms(self) -> float:
        """Of the difference, N."""
        return float(np.sqrt(np.mean(self.added**2)))

    @property
    def absent(self) -> bool:
        """Whether the effect does nothing on this loop."""
        return self.rms < NOTHING * float(np.abs(self.without).max())


def signature_of(kind: type[AbstractEffect]) -> Signature:
    """Simulate the loop with and without an effect.

    Args:
        kind: A member of `EFFECTS`, taken in its first form at its nominal size.
    """
    from sysid.models.damper import Damper
    from sysid.models.generalized import LOW_SYMMETRIC, Generalized
    from sysid.motion.history import run_history, with_history
    from sysid.motion.motion import sine_motion
    from sysid.parameters import build

    two = np.ones(2)
    currents = np.array([0.4, CURRENT])  # lowered before the test that is drawn
    motion = sine_motion(
        AMPLITUDE * two, FREQUENCY * two, currents, TEMPERATURE * two, points=POINTS
    )
    motion = with_history(motion, run_history(np.arange(2), currents), cycle=np.zeros(2))
    valve = build(Generalized, LOW_SYMMETRIC)
    with_effect = Damper(valve, (make(kind),)).force(motion)
    return Signature(
        *(np.asarray(z)[1] for z in (motion.velocity, valve.force(motion), with_effect))
    )


def draw(kind: type[AbstractEffect], path: Path) -> None:
    """Draw the signature of an effect as a small SVG file."""
    import matplotlib as mpl

    mpl.use("svg")
    import matplotlib.pyplot as plt

    found = signature_of(kind)
    style: Any = {
        "svg.fonttype": "none", "svg.hashsalt": kind.facts.id, "font.size": 8,
        "font.family": "sans-serif", "axes.spines.top": False, "axes.spines.right": False,
        "path.simplify_threshold": 0.2, "axes.linewidth": 0.6,
    }  # fmt: skip
    with mpl.rc_context(style):
        figure, (loop, over_phase) = plt.subplots(1, 2, figsize=(6.4, 2.2), layout="constrained")
        for force, colour, width, name in (
            (found.without, "#9a9a9a", 2.2, "without"),
            (found.with_effect, "#0b62a4", 1.0, "with"),
        ):
            closed = np.append(np.arange(0, POINTS, EVERY), 0)
            loop.plot(found.velocity[closed], force[closed], colour, lw=width, label=name)
        loop.set(xlabel="velocity, m/s", ylabel="force, N")
        loop.legend(frameon=False, loc="upper left", handlelength=1.2)
        shown = slice(None, None, EVERY)
        phase = np.arange(POINTS) * 360.0 / POINTS
        over_phase.plot(phase[shown], found.added[shown], "#0b62a4", lw=1.0)
        over_phase.axhline(0.0, color="#9a9a9a", lw=0.6)
        over_phase.set(
            xlabel="phase, °", ylabel="added force, N", xlim=(0, 360), xticks=[0, 90, 180, 270, 360]
        )
        if found.absent:
            over_phase.set(ylim=(-1, 1))
            over_phase.set_title("nothing on this loop", fontsize=8)
        else:
            share = 100.0 * found.rms / float(np.abs(found.without).max())
            over_phase.set_title(
                f"RMS {found.rms:.3g} N, {share:.2g} % of the largest force", fontsize=8
            )
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, format="svg", metadata={"Date": None, "Creator": None})
        plt.close(figure)
    path.write_text(_smaller(path.read_text(encoding="utf-8")), encoding="utf-8")


def _smaller(svg: str) -> str:
    """Coordinates to a tenth of a point, one element after the other."""
    svg = re.sub(r"<[^>]+>", lambda tag: re.sub(r"(-?\d+\.\d)\d+", r"\1", tag[0]), svg)
    svg = re.sub(r"<!--.*?-->", "", svg, flags=re.DOTALL)
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    svg = re.sub(r"\s*\n(?=[LMz])", "", svg)
    svg = re.sub(r' transform="rotate\(-0 [^)]*\)"', "", svg)
    svg = re.sub(r' style="stroke: #000000; stroke-width: 0.8"', ' stroke="#000"', svg)
    svg = re.sub(r"font-family: [^;]*sans-serif", "font-family: sans-serif", svg)
    return re.sub(r">\s+<", ">\n<", svg)


def page() -> str:
    """The catalogue as Markdown."""
    families: dict[str, list[type[AbstractEffect]]] = {}
    for kind in EFFECTS:
        families.setdefault(kind.facts.family, []).append(kind)
    table = ["| family | effects |", "|---|---|"]
    for family, kinds in families.items():
        links = ", ".join(f"[`{k.facts.id}`](#{k.facts.id})" for k in kinds)
        table.append(f"| {_words(family)} | {links} |")
    ways = Counter(kind.facts.found_from for kind in EFFECTS)
    head = HEAD.format(named=ways["loops"] + ways["history"], **ways)
    text = [head, f"{len(EFFECTS)} effects in {len(families)} families:\n", "\n".join(table), ""]
    for family, kinds in families.items():
        text.append(f"\n## Family: {_words(family)}\n")
        text.extend(_entry(kind) for kind in kinds)
    return "\n".join(text).rstrip() + "\n"


def _words(name: str) -> str:
    return name.replace("_", " ")


def _entry(kind: type[AbstractEffect]) -> str:
    facts = kind.facts
    module = sys.modules[kind.__module__]
    title = (module.__doc__ or "").strip().splitlines()[0]
    lines = [f"### {facts.id}\n", f"*{title}* {_explained(kind)}\n"]
    lines += [f"![{facts.id}: loop and added force](images/effects/{facts.id}.svg)\n"]
    lines += ["| parameter | | unit | nominal | realistic | allowed |", "|---|---|---|---|---|---|"]
    lines += [_row(spec, kind) for spec in specs(kind)]
    lines += ["", f"- place: {STAGES[kind.stage]} (`{kind.stage}`)"]
    lines += [f"- seen in: {FOUND_FROM[facts.found_from]}"]
    if len(choices(kind)) > 1:
        forms = "; ".join(", ".join(f"{k} = {v}" for k, v in c.items()) for c in choices(kind))
        lines += [f"- forms: {forms}"]
    if facts.parity is None:
        lines += ["- symmetry: none that is clear"]
    else:
        parity, share = facts.parity
        lines += [f"- symmetry: {PARITIES[parity]} ({parity}, {100 * share:.0f} % of its energy)"]
    if facts.exponents is None:
        lines += ["- growth: no power law"]
    else:
        p, q, r = facts.exponents
        lines += [f"- growth: A^{p:g} f^{q:g} i^{r:g}"]
    if facts.rivals:
        lines += ["- looks like: " + ", ".join(f"[`{r}`](#{r})" for r in facts.rivals)]
    lines += [f"- told apart by: {facts.separating_test}", f"- source: {_source(kind)}\n"]
    return "\n".join(lines)


def _row(spec: ParamSpec, kind: type[AbstractEffect]) -> str:
    facts = kind.facts
    low, high = facts.realistic[spec.symbol]
    size = " (size)" if spec.symbol == facts.size else ""
    unit = "" if spec.unit == "-" else spec.unit
    return (
        f"| `{spec.symbol}`{size} | {spec.name} | {unit} | {facts.nominal[spec.symbol]:g} "
        f"| {low:g} … {high:g} | {_allowed(spec)} |"
    )


def _allowed(spec: ParamSpec) -> str:
    low, high = np.isfinite(spec.low), np.isfinite(spec.high)
    if low and high:
        return f"{spec.low:g} … {spec.high:g}"
    if low:
        return f"≥ {spec.low:g}"
    return f"≤ {spec.high:g}" if high else "any"


_SECTION: Final = re.compile(r"^(Source|Attributes|Args|Returns|Raises|Note)s?:$")


def _doc(kind: type[AbstractEffect]) -> list[str]:
    return (inspect.getdoc(kind) or "").splitlines()


def _explained(kind: type[AbstractEffect]) -> str:
    """The docstring up to its first section, equations as code."""
    out: list[str] = []
    code = False
    for line in _doc(kind):
        if _SECTION.match(line):
            break
        indented = line.startswith("    ")
        if indented != code and (indented or line.strip()):
            out.append("```text" if indented else "```")
            code = indented
            if not indented:
                out.append("")
        out.append(line[4:] if indented else _plain(line))
    while out and not out[-1].strip():
        out.pop()
    if code:
        out.append("```")
    return re.sub(r"\n+```\n", "\n```\n", "\n".join(out).strip())


def _plain(line: str) -> str:
    """Outside of code, signs that Markdown would take for its own."""
    parts = line.split("`")
    parts[::2] = [re.sub(r"([*_|<>])", r"\\\1", part) for part in parts[::2]]
    return "`".join(parts)


def _source(kind: type[AbstractEffect]) -> str:
    lines = _doc(kind)
    start = next(i for i, line in enumerate(lines) if line.strip() == "Source:")
    found: list[str] = []
    for line in lines[start + 1 :]:
        if line and not line.startswith("    "):
            break
        found.append(line.strip())
    return _plain(" ".join(found).strip())


def main() -> None:
    """Write page and figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--page", action="store_true", help="only the page")
    alone = parser.parse_args().page
    PAGE.write_text(page(), encoding="utf-8")
    for kind in () if alone else EFFECTS:
        draw(kind, FIGURES / f"{kind.facts.id}.svg")
    print(f"{len(EFFECTS)} effects in {PAGE.relative_to(HERE.parent)}")


if __name__ == "__main__":
    main()
