"""Parameters are declared once and understood everywhere."""

import dataclasses
import re

import jax.numpy as jnp
import pytest

from sysid.identification.families import FAMILIES
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.parameters import as_dict, build, specs, values
from sysid.units import find_unit

MODELS = [family.valve for family in FAMILIES]


@pytest.mark.parametrize("model", MODELS)
def test_every_declaration_is_whole(model):
    for spec in specs(model):
        field = next(f for f in dataclasses.fields(model) if f.name == spec.symbol)
        assert field.metadata["param"] is spec
        assert spec.name
        assert spec.low < spec.high
        assert spec.low <= spec.typical <= spec.high


@pytest.mark.parametrize("model", MODELS)
def test_units_are_made_of_si_symbols(model):
    for spec in specs(model):
        for part in re.split(r"[·/()]+", spec.unit):
            if part not in ("1", "-", ""):
                quantity = {"N": "force", "A": "current", "s": "time", "m": "displacement"}[part]
                assert find_unit(part, quantity).factor == 1.0


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
