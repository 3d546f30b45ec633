"""Loops on the first screen: drawn into the page itself, to scale, with every curve of the test."""

import re

import numpy as np
import pytest

from sysid.report.page.look import AFTER, BEFORE, MEASURED, looks
from sysid.report.page.loop_figure import HEIGHT, LEFT, WIDTH, _short, loop_figures, round_numbers
from sysid.report.page.one_test import Traces
from sysid.report.page.render import render
from tests.report.made_page import Read, many_page

PHASE = np.linspace(0.0, 2 * np.pi, 180, endpoint=False)


def traces(**other) -> Traces:
    force = 100.0 * np.tanh(8 * np.cos(PHASE)) + 30.0
    told = {
        "over": "phase", "along": np.degrees(PHASE), "displacement": 0.01 * np.sin(PHASE),
        "velocity": 0.2 * np.cos(PHASE), "force": force, "models": (0.9 * force, force),
    }  # fmt: skip
    return Traces(**{**told, **other})


def points(path):
    return np.array([[float(z) for z in p.split()] for p in re.findall(r"[\d.-]+ [\d.-]+", path)])


def test_curves_are_drawn_to_scale():
    drawn = traces()
    velocity, displacement = loop_figures(drawn, "measured", ("one", "two"))
    assert [z.look for z in velocity.lines] == [MEASURED, BEFORE, AFTER]
    assert [z.name for z in displacement.lines] == ["measured", "one", "two"]
    for figure, x in ((velocity, drawn.velocity), (displacement, 1e3 * drawn.displacement)):
        ticks = {z.text: z.at for z in figure.x_ticks}
        assert ticks["0"] == figure.x_zero
        places = np.array([z.at for z in figure.x_ticks])
        numbers = np.array([float(t.replace("−", "-")) for t in ticks])
        scale, zero = np.polyfit(numbers, places, 1)
        found = points(figure.lines[0].path)
        assert np.abs(found[:, 0] - (zero + scale * x)).max() < 0.2
        for line in figure.lines:
            assert line.path.endswith("Z")
            p = points(line.path)
            assert p.shape == (180, 2)
            assert (p > [LEFT, figure.top]).all()
            assert (p < [WIDTH, HEIGHT]).all()
        assert figure.y_zero == next(z.at for z in figure.y_ticks if z.text == "0")


def test_a_history_is_not_closed_and_an_unknown_force_not_drawn():
    drawn = traces(over="time", models=(np.full(180, np.nan), np.zeros(180)))
    figure, _ = loop_figures(drawn, "measured", ("one", "two"))
    assert [z.name for z in figure.lines] == ["measured", "two"]
    assert figure.lines[1].look == AFTER
    assert not figure.lines[0].path.endswith("Z")


def test_a_force_of_zero_has_axes_too():
    still = np.zeros(180)
    figure, _ = loop_figures(
        traces(force=still, models=(), velocity=still), "measured", ("one",)
    )  # fmt: skip
    assert len(figure.x_ticks) > 1
    assert len(figure.y_ticks) > 1


def test_many_long_names_take_rows_and_are_cut():
    names = tuple(f"a card with a very long name, number {k}" for k in range(7))
    drawn = traces(models=(PHASE,) * 7)
    figure, _ = loop_figures(drawn, "measured", names)
    assert max(len(z.name) for z in figure.lines) == 30
    assert max(z.top for z in figure.lines) < figure.top
    assert len({(z.left, z.top) for z in figure.lines}) == 8
    assert looks(1) == (AFTER,)
    assert looks(2) == (BEFORE, AFTER)
    for count in range(1, 7):
        assert len(set(looks(count))) == count
        assert looks(count)[-1] == AFTER  # the last one is the best, or the extended one


@pytest.mark.parametrize(
    ("low", "high", "numbers"),
    [
        (-1.05, 1.05, [-1.0, -0.5, 0.0, 0.5, 1.0]), (0.0, 10.0, [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]),
        (-130.0, 40.0, [-100.0, -50.0, 0.0]), (3e-4, 7e-4, [3e-4, 4e-4, 5e-4, 6e-4, 7e-4]),
    ],
)  # fmt: skip
def test_axes_have_round_numbers(low, high, numbers):
    assert round_numbers(low, high) == pytest.approx(numbers)


def test_the_first_screen_needs_no_script():
    read = Read(render(many_page()))
    drawn = [k for k, (tag, _) in enumerate(read.tags) if tag == "svg"]
    assert len(drawn) == 2
    first = [a for tag, a in read.tags[drawn[0] :] if tag == "path" and a.get("fill") == "none"]
    assert [a["stroke"] for a in first[:6:2]] == [MEASURED.colour, BEFORE.colour, AFTER.colour]
    assert "force / N" in read.text


def test_long_names_are_told_apart_by_their_ends():
    one, two = (_short(f"/somewhere/deep/in/a/tree/run-{k}/card.json") for k in (1, 2))
    assert one != two
    assert one.endswith("run-1/card.json")
