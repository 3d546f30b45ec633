"""Pages made by hand: of the diagnoses of `made_diagnosis`, and one of 165 tests."""

from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from typing import Any

import numpy as np

from sysid.cards.extended import card_of_diagnosis
from sysid.data.loops import Loops
from sysid.data.record import Conditions, Record, Source
from sysid.diagnosis.result import Diagnosis
from sysid.motion.motion import Motion
from sysid.report.diagnosis_json import diagnosis_json
from sysid.report.page.diagnosis_page import diagnosis_page
from sysid.report.page.headline import Bar, Headline
from sysid.report.page.one_test import absent_tests, history_test, loop_tests
from sysid.report.page.page import Page, make_page
from sysid.report.page.provenance import Origin, provenance
from tests.report.made_diagnosis import backlash

EVIL = (
    '</script><img src=x onerror="window.pwned=1">\'&amp;{{7*7}}<b>\u2028',
    "<a href='javascript:window.pwned=1'>12.5mm</a>%s{0}",
)
LEFT_OUT = {"broken": "dropout: the force was gone for 0.2 s"}
COMMAND = "sysid diagnose 'my <tests>' -o out"


def record_of(name: str) -> Record:
    t = np.linspace(0.0, 1.0, 5)
    return Record(name, t, t, t, source=Source(f"{name}.csv", "0" * 64, changes=("mm to m",)))


def summary_of(d: Diagnosis) -> dict[str, Any]:
    return diagnosis_json(d, left_out=LEFT_OUT)


def page_of(d: Diagnosis, campaign: str = "A damper") -> Page:
    records = [record_of(name) for name in (*d.loops.ids, *LEFT_OUT)]
    if not d.damper.effects:
        d = without_effect(d)
    card = card_of_diagnosis(d, records, damper=campaign, campaign=campaign)
    origin = Origin(campaign, records, COMMAND, "my <tests>", "out", 7, notes=("a note",))
    return diagnosis_page(d, card, summary_of(d), origin)


def without_effect(d: Diagnosis) -> Diagnosis:
    """Symbols and covariance of the base model alone."""
    kept = np.array(["." not in symbol for symbol in d.symbols])
    return replace(
        d, symbols=tuple(s for s in d.symbols if "." not in s), values=d.values[kept],
        covariance=d.covariance[np.ix_(kept, kept)],
    )  # fmt: skip


def renamed(d: Diagnosis, *names: str) -> Diagnosis:
    """The same with the first tests named otherwise."""
    ids = (*names, *d.loops.ids[len(names) :])
    gain = None if d.gain is None else replace(d.gain, held_out=ids)
    return replace(d, loops=replace(d.loops, ids=ids), gain=gain)


@cache
def evil_page() -> Page:
    return page_of(renamed(backlash(), *EVIL), campaign=EVIL[0])


def many_loops(count: int = 165, points: int = 360) -> tuple[Loops, np.ndarray]:
    """Loops of 33 conditions at 5 currents, and their forces without noise."""
    k = np.arange(count)
    a, f = 2.5e-3 * (1 + k // 5 % 11), 0.5 * (1 + k // 55)
    i = 0.1 * (k % 5)
    phase = 2 * np.pi * np.arange(points) / points
    omega = 2 * np.pi * f[:, None]
    x = a[:, None] * np.sin(phase)
    v = omega * a[:, None] * np.cos(phase)
    force = (100 + 2000 * i[:, None]) * np.tanh(40 * v) + 800 * v + 900 * x
    noise = np.random.default_rng(3).normal(0.0, 5.0, force.shape)
    harmonics = np.zeros((count, 15), dtype=complex)
    harmonics[:, 0] = a
    loops = Loops(
        ids=tuple(f"{1e3 * a[n]:g}mm_{f[n]:g}Hz_{i[n]:.1f}A_{n}" for n in k), displacement=x,
        velocity=v, acceleration=-(omega**2) * x, force=force + noise, amplitude=a, frequency=f,
        current=i, temperature=np.full(count, 40.0), centre=np.zeros(count),
        cycles=np.full(count, 5), noise_floor=np.full(count, 11.0),
        deviations=tuple(np.zeros((0, points)) for _ in k),
        displacement_deviations=tuple(np.zeros((0, points)) for _ in k), harmonics=harmonics,
    )  # fmt: skip
    return loops, force


def many_page(count: int = 165) -> Page:
    """165 tests with two models, one that is no sinusoid, and one that was left out."""
    loops, force = many_loops(count)
    forces = (0.93 * force, force)
    peak = np.abs(loops.force).max(axis=1)
    errors = {
        name: tuple(float(np.sqrt(np.mean((z[k] - loops.force[k]) ** 2)) / peak[k]) for z in forces)
        for k, name in enumerate(loops.ids)
    }
    n = 20_000
    t = np.linspace(0.0, 20.0, n)
    swept = Record(
        "swept", t, 0.01 * np.sin(t**2), 900 * np.cos(t**2), nominal=Conditions(kind="random")
    )
    motion = _motion_of(swept)
    tests = (
        *loop_tests(loops, forces, errors, dict.fromkeys(loops.ids, "fitted")),
        history_test(swept, motion, (0.9 * swept.force, swept.force), (0.07, 0.0), "held out"),
        *absent_tests(LEFT_OUT, ()),
    )
    origin = Origin("Many tests", [record_of(name) for name in loops.ids], seed=0)
    bars = (Bar("before", 0.05, "before"), Bar("after", 0.01, "after"))
    return make_page(
        title="Many tests", what="Diagnosis", models=("base model", "extended model"),
        headline=Headline("A verdict.", (), (), bars, "Words."), tests=tests,
        provenance=provenance(origin, {}, None),
    )  # fmt: skip


def _motion_of(record: Record) -> Motion:
    from sysid.identification.problem import record_motion

    return record_motion(replace(record, current=np.full(record.time.size, 0.2)))


class Read(HTMLParser):
    """What a browser would find in a page.

    Attributes:
        tags: (name, attributes) of all elements.
        text: Of everything but scripts and styles.
        scripts: id → content.
        style: Content of the style elements.
    """

    VOID = ("meta", "br", "img", "input", "link", "hr")

    def __init__(self, page: bytes) -> None:
        super().__init__(convert_charrefs=True)
        self.tags: list[tuple[str, dict[str, str]]] = []
        self.text, self.style = "", ""
        self.scripts: dict[str, str] = {}
        self.open: list[str] = []
        self._script = ""
        self.feed(page.decode())
        self.close()
        assert self.open == [], self.open

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, {k: v or "" for k, v in attrs}))
        if tag not in self.VOID:
            self.open.append(tag)
        if tag == "script":
            self._script = dict(attrs).get("id") or "code"
            self.scripts[self._script] = ""

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, tag

    def handle_data(self, data):
        inside = self.open[-1] if self.open else ""
        if inside == "script":
            self.scripts[self._script] += data
        elif inside == "style":
            self.style += data
        else:
            self.text += data

    @property
    def cells(self) -> list[dict[str, str]]:
        return [a for tag, a in self.tags if tag == "button" and "data-test" in a]

    def count(self) -> dict[str, int]:
        names = [tag for tag, _ in self.tags]
        return {name: names.count(name) for name in sorted(set(names))}
