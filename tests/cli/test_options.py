"""Numbers with units on the command line."""

import pytest
import typer

from sysid.cli.options import VARIANTS, Model, join_ranges, quantity, span, variant_of
from sysid.identification.families import FAMILIES


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("12.5mm", "displacement", 0.0125),
        ("0.5 in", "displacement", 0.0127),
        ("1.5Hz", "frequency", 1.5),
        ("200mA", "current", 0.2),
        ("-.5A", "current", -0.5),
        ("1e-1A", "current", 0.1),
        ("40C", "temperature", 40.0),
        ("104°F", "temperature", 40.0),
    ],
)
def test_quantities(text, kind, value):
    assert quantity(text, kind, "--x") == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "kind", "message"),
    [
        ("12.5", "displacement", "not a number with a unit; write for example 12.5mm"),
        ("mm", "displacement", "not a number with a unit"),
        ("12,5mm", "displacement", "not a number with a unit"),
        ("12.5Mm", "displacement", "'Mm' of displacement is not known"),
        ("12.5N", "displacement", "'N' is a unit of force"),
        ("nanmm", "displacement", "not a number"),
        ("1e999mm", "displacement", "too large"),
    ],
)
def test_bad_quantities_are_wrong_usage(text, kind, message):
    with pytest.raises(typer.BadParameter, match=message):
        quantity(text, kind, "--x")


@pytest.mark.parametrize("text", ["2.5 13", "2.5mm 13mm", "2.5 mm 13 mm", "0.25cm 13mm"])
def test_ranges(text):
    ends = span(text, "displacement", "--amplitude-range", "mm")
    assert ends == pytest.approx((0.0025, 0.013), rel=1e-12)


@pytest.mark.parametrize("text", ["1", "1 2 3", "2 1", "a b", "1N 2N"])
def test_bad_ranges_are_wrong_usage(text):
    with pytest.raises(typer.BadParameter):
        span(text, "frequency", "--frequency-range", "Hz")


def test_two_values_of_a_range_become_one_argument():
    words = ["fit", "c", "--frequency-range", "0.5", "5", "-o", "d", "--frequency-range", "5", "15"]
    assert join_ranges(words) == [
        "fit", "c", "--frequency-range", "0.5 5", "-o", "d", "--frequency-range", "5 15",
    ]  # fmt: skip
    short = ["fit", "--frequency-range", "0.5", "-o", "d"]
    assert join_ranges(short) == short
    assert join_ranges(["--amplitude-range"]) == ["--amplitude-range"]


def test_models_and_variants_are_those_that_can_be_fitted():
    """The command line knows them as plain text, since the table of families loads JAX."""
    assert {model.value: known for model, known in VARIANTS.items()} == {
        family.name: family.variants for family in FAMILIES
    }
    assert [model.value for model in Model] == [family.name for family in FAMILIES]


def test_a_model_has_its_own_variants():
    assert variant_of(Model.generalized, None) == "asymmetric"
    assert variant_of(Model.dahl, None) == "full"
    assert variant_of(Model.generalized, "mean") == "mean"
    with pytest.raises(typer.BadParameter, match="dahl model has no variant 'mean'; it has: full"):
        variant_of(Model.dahl, "mean")


@pytest.mark.parametrize(
    ("typed", "joined"),
    [
        (["--frequency-range", "0.5", "5", "data"], ["--frequency-range", "0.5 5", "data"]),
        (["--frequency-range", "0.5 5", "data"], ["--frequency-range", "0.5 5", "data"]),
        (["--amplitude-range", "2 mm", "13 mm", "x"], ["--amplitude-range", "2 mm 13 mm", "x"]),
        (["--amplitude-range", "2 mm 13mm", "x"], ["--amplitude-range", "2 mm 13mm", "x"]),
    ],
)
def test_two_ends_are_one_value_in_quotes_or_not(typed, joined):
    assert join_ranges(typed) == joined
