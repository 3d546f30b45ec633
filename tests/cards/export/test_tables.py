"""The look-up table: what it keeps, and that it tells what it loses."""

import csv

import numpy as np
import pytest

from sysid.cards.export.tables import NO_LAW, table_csv, table_of
from sysid.cards.models import damper_of
from sysid.effects.registry import effect_kind, make
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.parameters import build
from tests.cards.example import card_with, example_card
from tests.isolator.conftest import lumped_card


@pytest.fixture(scope="module")
def table():
    return table_of(example_card(), Damper(build(Generalized, LOW_SYMMETRIC), ()))


def test_a_symmetric_damper_has_a_symmetric_table(table):
    assert np.allclose(table.force, -table.force[:, :, ::-1], atol=1e-6 * table.force.max())
    assert np.allclose(table.rising, -table.falling[:, :, ::-1], atol=0.02 * table.force.max())


def test_it_keeps_the_energy_and_loses_the_width(table):
    assert table.energy == pytest.approx(1.0, abs=0.02)
    assert table.lost > 0.02
    middle = table.speed.size // 2
    assert np.all(table.rising[:, 1:, middle] < table.falling[:, 1:, middle] - 50.0)


def test_without_width_nothing_is_lost():
    thin = Damper(build(Generalized, LOW_SYMMETRIC | {"k_4": 0.0}), ())
    assert table_of(example_card(), thin).lost < 0.01


def test_the_file_says_so_and_is_read_by_any_reader(table):
    text = table_csv(table, example_card())
    told = [line for line in text.splitlines() if line.startswith("#")]
    assert any("no memory" in line for line in told)
    assert any(f"{table.lost:.1%}" in line for line in told)
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    assert len(rows) == table.force.size
    assert float(rows[0]["force_N"]) == pytest.approx(table.force[0, 0, 0])


def test_a_law_that_bends_at_a_current_is_tabled_there():
    """Between two currents of BS09's Table 1 a straight line would cut the corner."""
    made = lumped_card()
    damper = damper_of(made)
    table = table_of(made, damper)
    low, high = made.validity.current
    bends = [i for i in damper.valve.currents if low <= i <= high]
    assert len(bends) > 2
    assert set(bends) <= set(table.current.tolist())


def test_what_the_table_leaves_out_is_said():
    made = card_with(make(effect_kind("run_drift")))
    table = table_of(made, damper_of(made))
    told, _ = table.without_say
    assert told.startswith("run_drift has no say here")
    assert f"# Note: {told}" in table_csv(table, made)


def test_without_a_law_of_temperature_one_is_tabled_and_that_is_said(table):
    assert table.temperature.tolist() == [40.0]
    assert f"# Note: {NO_LAW}" in table_csv(table, example_card())
    made = card_with(make(effect_kind("viscosity_temperature")))
    warm = table_of(made, damper_of(made))
    assert warm.temperature.size == 5
    assert np.ptp(warm.force, axis=0).max() > 1.0
    assert NO_LAW not in warm.without_say
