"""The magnetic circuit: linear limit, saturation, remanence, hysteresis, lag."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.rig.physical.magnet import MU_0, after_history, field_yield_stress, fluid_density
from sysid.rig.physical.rd1005 import RD_1005

MAGNET, GAP, SOLIDS = RD_1005.magnet, 0.75e-3, 0.32
SOFT = replace(MAGNET, coercive=0.0)


def _field(magnet, *currents):
    return float(after_history(magnet, GAP, SOLIDS, np.array(currents)[:, None])[0])


def test_iron_without_reluctance_leaves_all_ampere_turns_to_the_gaps():
    ideal = replace(SOFT, permeability=1e9, saturation=100.0)
    assert _field(ideal, 0.5) == pytest.approx(0.5 * MAGNET.turns / (2.0 * GAP), rel=1e-6)


def test_amperes_law_round_the_circuit():
    field = _field(SOFT, 0.8)
    core = fluid_density(np.asarray(field), SOLIDS) * MAGNET.narrowing
    iron = core / (MU_0 * 1000.0) / (1.0 - (core / 2.0) ** 8)
    assert 2.0 * GAP * field + MAGNET.iron * iron == pytest.approx(0.8 * MAGNET.turns, rel=1e-9)


def test_saturated_iron_holds_the_flux():
    low, high = (fluid_density(np.asarray(_field(SOFT, i)), SOLIDS) for i in (5.0, 50.0))
    assert high * MAGNET.narrowing == pytest.approx(2.0, rel=1e-3)
    assert high / low < 1.15


def test_the_fluid_saturates_at_its_data_sheets_48_kpa():
    assert field_yield_stress(np.asarray(1e7), SOLIDS) == pytest.approx(47.9e3, rel=2e-3)


def test_field_is_left_after_the_current_and_taken_off_by_a_reversed_one():
    left = _field(MAGNET, 1.0, 0.0)
    # far from the reversal the iron's lag is whole: 2 h H + l H_iron = l H_c
    core = float(fluid_density(np.asarray(left), SOLIDS)) * MAGNET.narrowing
    iron = core / (MU_0 * MAGNET.permeability)
    assert 2.0 * GAP * left + MAGNET.iron * iron == pytest.approx(60e-3 * 150.0, rel=1e-3)
    assert abs(_field(MAGNET, 1.0, 0.0, -0.05, 0.0)) < 0.5 * left
    assert _field(MAGNET, 0.0) == pytest.approx(0.0, abs=1e-6)


def test_a_current_reached_from_above_leaves_more_field_than_from_below():
    rising, falling = _field(MAGNET, 0.4), _field(MAGNET, 1.0, 0.4)
    width = 2.0 * MAGNET.iron * MAGNET.coercive / MAGNET.turns  # in ampere
    slope = (_field(SOFT, 0.41) - _field(SOFT, 0.39)) / 0.02
    assert falling - rising == pytest.approx(width * slope, rel=0.05)
    assert _field(SOFT, 1.0, 0.4) == pytest.approx(_field(SOFT, 0.4), rel=1e-9)


def test_the_current_lags_by_inductance_over_all_resistance():
    assert MAGNET.lag == pytest.approx(3e-3, rel=0.02)
    assert replace(MAGNET, amplifier=0.0).lag == pytest.approx(MAGNET.inductance / 5.0)
