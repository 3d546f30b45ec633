"""Units: exact factors, no guessing."""

import numpy as np
import pytest

from sysid.errors import UnitError
from sysid.units import SI_SYMBOL, UNITS, find_unit, from_si, to_si


@pytest.mark.parametrize(
    ("symbol", "quantity", "number", "si"),
    [
        ("mm", "displacement", 12.5, 0.0125),
        ("in", "displacement", 1.0, 0.0254),
        ("in/s", "velocity", 10.0, 0.254),
        ("kN", "force", 1.5, 1500.0),
        ("lbf", "force", 1.0, 4.4482216152605),
        ("mA", "current", 250.0, 0.25),
        ("ms", "time", 3.0, 0.003),
        ("K", "temperature", 313.15, 40.0),
        ("degF", "temperature", 104.0, 40.0),
        ("°C", "temperature", 40.0, 40.0),
        ("deg", "phase", 180.0, np.pi),
    ],
)
def test_known_conversions(symbol, quantity, number, si):
    unit = find_unit(symbol, quantity)
    assert float(to_si(number, unit)) == pytest.approx(si, rel=1e-12)
    assert float(from_si(si, unit)) == pytest.approx(number, rel=1e-12)


@pytest.mark.parametrize("unit", UNITS, ids=lambda u: f"{u.symbol} of {u.quantity}")
def test_there_and_back(unit):
    numbers = np.array([-3.0, 0.0, 1e-6, 7.25, 1e6])
    np.testing.assert_allclose(from_si(to_si(numbers, unit), unit), numbers, rtol=1e-9, atol=1e-9)


def test_si_units_of_the_program_change_nothing():
    for quantity, symbol in SI_SYMBOL.items():
        assert float(to_si(2.5, find_unit(symbol, quantity))) == 2.5


@pytest.mark.parametrize("symbol", ["Mm", "furlong", "", "n", "KN"])
def test_unknown_units_are_refused_with_what_is_known(symbol):
    with pytest.raises(UnitError, match="Known units of force: N, kN, lbf, kgf"):
        find_unit(symbol, "force")


def test_unit_of_another_quantity_is_named():
    with pytest.raises(UnitError, match=r"rig\.csv, line 3: 'mm' is a unit of displacement, not"):
        find_unit("mm", "force", where="rig.csv, line 3")
