"""Conditions from file names."""

import pytest

from sysid.data.names import compile_pattern, conditions_in_name
from sysid.errors import ManifestError


@pytest.mark.parametrize(
    ("stem", "expected"),
    [
        (
            "12.5mm_1.5Hz_0.2A_40C_run3",
            {"amplitude": 0.0125, "frequency": 1.5, "current": 0.2, "temperature": 40},
        ),
        ("25mm0x25Hz_0x75A", {"amplitude": 0.025, "frequency": 0.25, "current": 0.75}),
        ("10mm2Hz_1A", {"amplitude": 0.01, "frequency": 2.0, "current": 1.0}),
        (
            "10mm-2Hz-250mA_-10C",
            {"amplitude": 0.01, "frequency": 2.0, "current": 0.25, "temperature": -10},
        ),
        (
            "0.5in 3Hz 24V 300K",
            {"amplitude": 0.0127, "frequency": 3.0, "voltage": 24.0, "temperature": 26.85},
        ),
        ("rig4_oilA_run12", {}),
        ("5mmx_2Hzz", {}),
    ],
)
def test_default_reading(stem, expected):
    found, notes = conditions_in_name(stem)
    assert found == pytest.approx(expected)
    assert notes == ()


def test_a_name_that_contradicts_itself_tells_nothing_and_says_so():
    found, notes = conditions_in_name("5mm_2Hz_0.5A_1A")
    assert found == pytest.approx({"amplitude": 0.005, "frequency": 2.0})
    assert "current 2 times" in notes[0]


def test_a_number_with_an_exponent_is_not_torn_apart():
    """0.4 A, written so: 1 A was read of what stands behind the hyphen."""
    found, notes = conditions_in_name("12.5mm_5Hz_4e-1A")
    assert "current" not in found
    assert len(notes) == 1
    assert "'4e-1A'" in notes[0]


def test_pattern():
    pattern = compile_pattern("{amplitude}mm{frequency}Hz_{current}A")
    assert pattern.read("25mm0x5Hz_0x25A") == pytest.approx(
        {"amplitude": 0.025, "frequency": 0.5, "current": 0.25}
    )
    assert pattern.read("25mm0x5Hz_1A_again") is not None
    assert pattern.read("25mm0x5Hz_1Ampere") is None
    assert pattern.read("tare") is None
    assert compile_pattern("no{run_order}_{}_{current}mA").read("no7_x_500mA") == pytest.approx(
        {"run_order": 7, "current": 0.5}
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{amplitude}_{frequency}Hz", "no unit stands behind {amplitude}"),
        ("{speed}m/s", "{speed}"),
        ("{current}A_{current}A", "twice"),
        ("{current}A_{frequency", "malformed"),
        ("nothing", "no fields"),
        ("{amplitude}Hz", "no unit"),
    ],
)
def test_a_bad_pattern_is_refused(text, words):
    with pytest.raises(ManifestError, match=words.replace("{", r"\{")):
        compile_pattern(text)
