"""Exported C against `sysid simulate --causal`, and its contracts."""

import ctypes
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

from sysid.cards.export import c_source, sources
from sysid.cards.export.c_program import c_program
from sysid.cards.export.compiler import compiler
from sysid.cards.export.pieces import BEHIND_NO_SPRING, WITHOUT_SAY, pieces_of
from sysid.cards.models import MODELS
from sysid.effects.registry import EFFECTS, choices
from sysid.errors import CardError
from sysid.models.damper import Damper
from sysid.models.simulate import simulate
from sysid.motion.time_motion import time_motion
from tests.cards.example import example_card
from tests.cards.export.dampers import CASES, damper, effect, valve
from tests.cards.export.program import COMPUTED, Program, needs_compiler, random_rows

SOURCES = Path(__file__).parents[3] / "sysid" / "cards" / "export" / "c"
REFUSED = {"surface_temperature"}


def simulated(damper: Damper, rows: np.ndarray) -> np.ndarray:
    t, x, v, _, i, warm = rows.T
    motion = time_motion(t, x, velocity=v, current=i, temperature=warm, causal=True)
    return np.asarray(simulate(damper, motion))


@needs_compiler
@pytest.mark.parametrize("case", CASES)
def test_forces_are_those_of_the_python_simulation(case, tmp_path):
    rows = random_rows()
    expected = simulated(damper(case), rows)
    force, codes = Program(CASES[case][0], damper(case), tmp_path).run(rows)
    assert np.isin(codes, COMPUTED).all()
    assert np.abs(force - expected).max() <= 1e-8 * np.abs(expected).max()


@needs_compiler
@pytest.mark.parametrize("form", [{"joint": "held"}, {"joint": "loose"}])
def test_play_is_used_up_in_the_direction_of_the_first_motion(form, tmp_path):
    """From rest, after a pause: where there is no speed yet, neither program knows a direction."""
    t = np.arange(1000) * 1e-3
    away = np.clip(t - 0.1, 0.0, None)
    x, v = 0.005 * (1.0 - np.cos(9.0 * away)), 0.045 * np.sin(9.0 * away)
    rows = np.stack([t, -x, -v, *np.full((3, t.size), [[np.nan], [0.2], [40.0]])], axis=1)
    whole, bare = (
        Damper(valve("generalized"), parts) for parts in ((effect("backlash", **form),), ())
    )
    force, codes = Program("generalized", whole, tmp_path).run(rows)
    expected = simulated(whole, rows)
    assert not codes.any()
    np.testing.assert_allclose(force, expected, atol=1e-8 * np.abs(expected).max())
    way = x[:440].argmax()
    np.testing.assert_allclose(force[150:way], simulated(bare, rows)[150:way], rtol=1e-8)


def test_every_model_and_every_effect_is_exported_or_refused_by_name():
    covered = {e.facts.id for _, effects in CASES.values() for e in effects}
    assert {model for model, _ in CASES.values()} == set(MODELS)
    assert {kind.facts.id for kind in EFFECTS} == covered | set(WITHOUT_SAY) | REFUSED


@pytest.mark.parametrize("kind", EFFECTS, ids=lambda kind: kind.facts.id)
def test_every_form_has_a_source_of_its_name(kind):
    for choice in choices(kind):
        whole = Damper(valve("generalized"), (kind(**kind.facts.nominal, **choice),))
        if kind.facts.id in REFUSED:
            with pytest.raises(CardError, match=kind.facts.id):
                pieces_of(whole, "generalized")
            continue
        pieces = pieces_of(whole, "generalized")
        told = [note for note in pieces.without_say if note.startswith(kind.facts.id)]
        assert bool(told) == (kind.facts.id in WITHOUT_SAY)
        for piece in pieces.all[1:]:
            if piece.kind != "series_compliance":
                text = (SOURCES / "effects" / f"{piece.kind}.c").read_text()
                assert re.search(rf"^static \w+ {piece.kind}\(", text, re.MULTILINE)


@pytest.mark.parametrize("kind", BEHIND_NO_SPRING)
def test_what_a_spring_cannot_be_solved_with_is_refused(kind):
    form = {"backlash_loose": {"joint": "loose"}, "width_law_yield": {"part": "yield"}}
    id = kind.removesuffix("_loose").removesuffix("_whole").removesuffix("_yield")
    behind = effect(id, **form.get(kind, {}))
    with pytest.raises(CardError, match=f"{kind} behind series_compliance"):
        pieces_of(Damper(valve("tanh"), (effect("series_compliance"), behind)), "tanh")


@needs_compiler
def test_only_the_past_counts(tmp_path):
    rows = random_rows(300)
    other = rows.copy()
    other[200:, 1:3] *= -1.5
    force = Program("lumped", damper("lumped"), tmp_path).run(rows)[0]
    changed = Program("lumped", damper("lumped"), tmp_path).run(other)[0]
    assert np.array_equal(force[:200], changed[:200])
    assert not np.array_equal(force[200:], changed[200:])


@needs_compiler
@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("column", [0, 1, 4])
def test_what_is_not_a_number_holds_the_force_and_changes_nothing(column, bad, tmp_path):
    rows = random_rows(60)
    program = Program("dahl", damper("dahl"), tmp_path)
    force, _ = program.run(rows)
    spoilt = np.insert(rows, 30, rows[30], axis=0)
    spoilt[30, column] = bad
    program.reset()
    found, codes = program.run(spoilt)
    assert codes[30] == 1
    assert found[30] == force[29]
    assert np.array_equal(np.delete(found, 30), force)


@needs_compiler
def test_time_that_does_not_increase_is_refused(tmp_path):
    program, rows = Program("dahl", damper("dahl"), tmp_path), random_rows(5)
    program.run(rows)
    assert program.step(rows[4].tolist())[1] == 1
    assert program.step(rows[2].tolist())[1] == 1


@needs_compiler
def test_without_velocity_it_is_that_of_the_last_three_places(tmp_path):
    rows = random_rows(400)
    t, x, _, _, i, warm = rows.T
    rows[:, 2] = np.nan
    motion = time_motion(t, x, current=i, temperature=warm, causal=True)
    expected = np.asarray(simulate(damper("carreau"), motion))
    force, _ = Program("carreau", damper("carreau"), tmp_path).run(rows)
    assert np.abs(force - expected).max() <= 1e-8 * np.abs(expected).max()


@needs_compiler
def test_a_delay_beyond_what_is_kept_is_told(tmp_path):
    late = Damper(valve("tanh"), (effect("force_delay", tau_F=0.5),))
    rows = np.zeros((4500, 6))
    rows[:, 0] = 1e-4 * np.arange(4500)
    codes = Program("tanh", late, tmp_path).run(rows)[1]
    assert np.isin(codes[:4095], COMPUTED).all()
    assert (codes[4200:] == 3).all()


@needs_compiler
def test_nested_searches_take_few_forces_of_the_valve(tmp_path, monkeypatch):
    """Forces of the valve a sample, for a leak behind a spring: 15 in the mean, 55 at most."""
    line = "    double bent = "
    counted = sources.source("valves/generalized.c")
    assert counted.count(line) == 1
    counted = f"long forces;\n\n{counted.replace(line, f'    forces++;{line}')}"
    monkeypatch.setattr(
        c_source, "source", lambda name: counted if "valves" in name else sources.source(name)
    )
    nested = ("series_compliance", "bypass_leakage", "presliding_friction", "gas_spring")
    program = Program(
        "generalized", Damper(valve("generalized"), tuple(map(effect, nested))), tmp_path
    )
    forces, taken = ctypes.c_long.in_dll(program.library, "forces"), [0]
    for row in random_rows(2000).tolist():
        assert program.step(row)[1] in COMPUTED
        taken.append(forces.value)
    each = np.diff(taken)[3:]
    assert each.mean() < 25.0
    assert each.max() < 150


def test_nothing_is_allocated():
    texts = {path.name: path.read_text() for path in SOURCES.rglob("*.c")}
    assert len(texts) > 50
    assert not [name for name, text in texts.items() if "alloc" in text]


@pytest.fixture(scope="module")
def tester(tmp_path_factory) -> Path:
    """The exported test program of a damper that goes by temperature."""
    folder = tmp_path_factory.mktemp("tester")
    for name, text in c_program(
        example_card(), pieces_of(damper("laws"), "generalized"), "u"
    ).items():
        (folder / name).write_text(text, encoding="utf-8")
    cc = compiler()
    assert cc is not None
    order = [cc, "-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "u.c", "u_test.c"]
    subprocess.run([*order, "-o", "test", "-lm"], cwd=folder, check=True)
    return folder / "test"


def read_by(tester: Path, text: str) -> subprocess.CompletedProcess[str]:
    file = tester.with_name("rows.csv")
    file.write_text(text, encoding="utf-8")
    return subprocess.run([tester, file], capture_output=True, text=True)


@needs_compiler
def test_what_a_file_does_not_tell_is_not_zero(tester):
    """Blank, missing or nan; a header and empty lines are no samples."""
    rows = random_rows(50)
    rows[:, 5] = np.nan
    plain = "\n".join(",".join(f"{z!r}" for z in row) for row in rows.tolist())
    expected = read_by(tester, plain + "\n")
    assert expected.returncode == 0, expected.stderr
    header = "time_s,displacement_m," + "a" * 600 + "\n"
    for blank in ("", "  "):
        short = plain.replace("nan", blank).replace(f",{blank}\n", "\n\n") + "\r\n"
        found = read_by(tester, header + short)
        assert found.stdout == expected.stdout, found.stderr
    warm = read_by(tester, plain.replace(",nan\n", ",0\n"))
    assert warm.stdout != expected.stdout


@needs_compiler
@pytest.mark.parametrize(
    "line",
    ["0.1,0.001,,", "0.1,,0.1,0,0.2,40", "0.1;0.001;0;0;0.2;40", "t,x,v,a,i,T", "0.1,0,x,0,0.2"],
)
def test_a_line_that_is_no_sample_is_told_by_its_number(line, tester):
    said = read_by(tester, f"time,x\n0,0,0,0,0.2,40\n{line}\n")
    assert said.returncode == 1
    assert "rows.csv, line 3: needs numbers" in said.stderr
    assert len(said.stdout.splitlines()) == 1
