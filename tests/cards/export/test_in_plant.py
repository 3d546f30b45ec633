"""The loop that the sign of acceleration closes where the damper decides on the acceleration."""

import numpy as np
import pytest

from sysid.cards.export.c_program import c_program
from sysid.cards.export.pieces import pieces_of
from sysid.cards.models import damper_of
from sysid.effects.registry import effect_kind, make
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.parameters import build
from tests.cards.example import card_with
from tests.cards.export.dampers import valve
from tests.cards.export.program import Program, needs_compiler

pytestmark = needs_compiler
MASS = 20.0


def branch(program: Program, row: list[float], side: float) -> float:
    """Force of a damper without past at an acceleration of that sign, next to zero."""
    program.reset()
    return program.step([*row[:3], side * 1e-9, *row[4:]])[0]


def test_mass_and_damper_are_in_balance(tmp_path):
    program = Program("generalized", Damper(valve("generalized"), ()), tmp_path)
    row = [0.0, 0.002, 0.03, np.nan, 0.2, 40.0]
    for rest in np.linspace(-1500.0, 1500.0, 61):
        program.reset()
        a, force, code = program.in_plant(row, MASS, rest)
        assert code == 0
        assert MASS * a + force == pytest.approx(rest, abs=1e-6)
        if a != 0.0:
            program.reset()
            assert program.step([*row[:3], a, *row[4:]])[0] == pytest.approx(force, abs=1e-6)


def test_where_both_signs_agree_the_last_one_stays(tmp_path):
    whole = Damper(valve("generalized"), ())
    row = [0.0, 0.0, -0.02, np.nan, 0.2, 40.0]
    program = Program("generalized", whole, tmp_path)
    up, down = branch(program, row, 1.0), branch(program, row, -1.0)
    assert up < down - 50.0, "k_4 < 0: the force lags behind the velocity"
    between, later = 0.5 * (up + down), [0.001, *row[1:]]
    for before, sign in ((up + 2000.0, 1.0), (down - 2000.0, -1.0)):
        program.reset()
        assert np.sign(program.in_plant(row, MASS, before)[0]) == sign
        assert np.sign(program.in_plant(later, MASS, between)[0]) == sign


def test_a_free_mass_loses_energy_and_comes_to_rest(tmp_path):
    symmetric = Damper(build(Generalized, LOW_SYMMETRIC), ())
    program = Program("generalized", symmetric, tmp_path)
    h, k, mass = 1e-4, 2e5, 200.0
    x, v = 0.005, 0.0
    energy = []
    for n in range(8000):
        a, _, code = program.in_plant([n * h, x, v, np.nan, 0.1, 40.0], mass, -k * x)
        assert code == 0
        v += h * a
        x += h * v
        energy.append(0.5 * mass * v * v + 0.5 * k * x * x)
    assert energy[-1] < 0.05 * energy[0]
    assert max(energy) <= 1.01 * energy[0]


def test_a_peak_speed_that_runs_away_is_told(tmp_path):
    program = Program("generalized", Damper(build(Generalized, LOW_SYMMETRIC), ()), tmp_path)
    code = program.in_plant([0.0, 0.01, 0.0, np.nan, 0.1, 40.0], 2.0, -2000.0)[2]
    assert code == 2, "W11 Eq. 10: v_m² = −a x, and the force grows with e^{a_1 v_m}"


@pytest.mark.parametrize(
    ("id", "there"),
    [
        ("gas_spring", True),
        ("force_clipping", False),
        ("force_filter", False),
        ("force_offset", False),
    ],
)
def test_what_the_recorder_does_is_no_force_on_the_mass(id, there):
    card = card_with(make(effect_kind(id)))
    program = c_program(card, pieces_of(damper_of(card), card.model), "damper")
    assert ("damper_step_in_plant" in program["damper.h"]) is there
    assert ("damper_step_in_plant" in program["damper.c"]) is there
