"""Numbers in messages and tables."""

import math

import pytest

from sysid.data.figures import ampere, condition, current_figures, figure


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (12345.6, 4, "12346"), (1234.0, 3, "1234"), (3.02e-6, 3, "0.00000302"), (0.0, 4, "0"),
        (99.996, 4, "100"), (-0.5, 4, "-0.5"), (0.25, 4, "0.25"), (math.nan, 4, "?"),
        (1e6, 3, "1000000"), (100.0, 4, "100"),
    ],
)  # fmt: skip
def test_no_exponents_and_no_lost_digits(value, digits, text):
    assert figure(value, digits) == text


def test_microamperes_of_a_supply_are_no_current():
    assert current_figures([3.02e-6, 0.2, 0.39998, -2e-6, None]) == (
        "A", ["0", "0.2", "0.4", "0", "?"],
    )  # fmt: skip
    assert current_figures([3.02e-6, -1e-6]) == ("A", ["0", "0"])
    assert ampere(3.02e-6) == "0 A"


def test_small_coils_are_told_in_milliamperes():
    assert current_figures([3.02e-6, 0.02, 0.0604]) == ("mA", ["0", "20", "60.4"])
    assert ampere(0.02) == "20 mA"


def test_conditions_have_their_unit():
    assert condition("amplitude", 0.0125) == "12.5 mm"
    assert condition("current", 0.25) == "0.25 A"
    assert condition("kind", "sine") == "sine"
