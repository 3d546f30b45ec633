"""Parameters are declared once and understood everywhere."""

import dataclasses
import re

import jax.numpy as jnp
import pytest

from sysid.identification.families import FAMILIES
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.models.lumped import TABLE_1, Lumped
from sysid.parameters import as_dict, build, specs, tables_of, values
from sysid.units import find_unit

MODELS = [family.valve for family in FAMILIES]
QUANTITIES = {"N": "force", "A": "current", "s": "time", "m": "displacement"}
UNITS = {*QUANTITIES, "kg", "K"}
"""Differences of temperature and masses are no quantities that are read from files."""


@pytest.mark.parametrize("model", MODELS)
def test_every_declaration_is_whole(model):
    declared = specs(model, {"currents": (0.0, 0.8)})
    assert len({spec.symbol for spec in declared}) == len(declared)
    for spec in declared:
        name = re.sub(r"\[.*\]", "", spec.symbol).replace(".", "_")
        field = next(f for f in dataclasses.fields(model) if f.name == name)
        assert field.metadata["param"].typical == spec.typical
        assert spec.name
        assert spec.low < spec.high
        assert spec.low <= spec.typical <= spec.high


@pytest.mark.parametrize("model", MODELS)
def test_units_are_made_of_si_symbols(model):
    for spec in specs(model, {"currents": (0.0, 0.8)}):
        for part in re.split(r"[·/()]+", spec.unit):
            if part in ("1", "-", ""):
                continue
            assert part in UNITS
            if part in QUANTITIES:
                assert find_unit(part, QUANTITIES[part]).factor == 1.0


def test_vector_and_mapping_build_the_same():
    valve = build(Generalized, LOW_SYMMETRIC)
    again = build(Generalized, values(valve))
    assert as_dict(again) == as_dict(valve) == LOW_SYMMETRIC
    assert values(valve).dtype == jnp.float64


@pytest.mark.parametrize(
    ("value", "words"),
    [(-1.0, "outside [0, inf]"), (float("nan"), "not a finite number"), (70.0, None)],
)
def test_values_are_checked_against_the_declaration(value, words):
    complaint = specs(Generalized)[0].check(value)
    assert complaint is None if words is None else words in complaint


def test_tables_are_expanded_at_their_places():
    valve = build(Lumped, TABLE_1)
    assert as_dict(valve) == TABLE_1
    assert [s.symbol for s in specs(Lumped, {"currents": valve.currents})] == list(as_dict(valve))
    spec = next(s for s in specs(valve) if s.symbol == "F_y[0.8 A].slope")
    assert (spec.name, spec.unit) == ("its change per kelvin at 0.8 A", "N/K")
    again = build(valve, 2.0 * values(valve))
    assert as_dict(again) == {symbol: 2.0 * value for symbol, value in TABLE_1.items()}


def test_places_are_read_from_symbols():
    symbols = ("F_y[1.5 A].slope", "C_post[0 A].slope", "C_pre", "C_post[-1 A].slope", "X[3 A]")
    assert tables_of(Lumped, symbols) == {"currents": (0.0, 1.5)}
    assert tables_of(Generalized, LOW_SYMMETRIC) == {}


@pytest.mark.parametrize("currents", [(), (-0.2, 0.0), (0.2, 0.2), (0.4, 0.2)])
def test_places_that_make_no_table_are_refused(currents):
    values = dict.fromkeys(
        (s.symbol.replace(".", "_") for s in specs(Lumped, {"currents": ()})), 1.0
    )
    column = dict.fromkeys(
        (f"{law}_{end}" for law in ("C_post", "F_y") for end in ("intercept", "slope")),
        [1.0] * len(currents),
    )
    with pytest.raises(ValueError, match="places that increase from 0"):
        Lumped(currents=currents, **values, **column)  # type: ignore[arg-type]  # by name
