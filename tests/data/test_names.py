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
        ("12.5MM_2HZ_0.2Amp", {"amplitude": 0.0125, "frequency": 2.0, "current": 0.2}),
        ("3inch_2hz_24Volts", {"amplitude": 0.0762, "frequency": 2.0, "voltage": 24.0}),
        ("12.5 mm 1.5 Hz 0.2 A", {"amplitude": 0.0125, "frequency": 1.5, "current": 0.2}),
        ("12.5 mm-1.5 Hz-0.2 Amps", {"amplitude": 0.0125, "frequency": 1.5, "current": 0.2}),
        (
            "5mm 2Hz 40 C 1 A",
            {"amplitude": 0.005, "frequency": 2.0, "temperature": 40.0, "current": 1.0},
        ),
        ("1 A 5 mm", {"amplitude": 0.005, "current": 1.0}),
        ("Damper 0.2 A", {"current": 0.2}),
        ("run_2_A", {}),
        ("run_4a", {}),
        ("5mm_pipe_run_5minutes", {"amplitude": 0.005}),
        *(
            (f"10 mm_2 Hz_{i} A", {"amplitude": 0.01, "frequency": 2.0, "current": float(i)})
            for i in ("0", "0.25", "0.5", "1", "1.5", "2")
        ),
        *(
            (f"{before}10mm_{between}1Hz_1A", {"amplitude": 0.01, "frequency": 1.0, "current": 1.0})
            for before, between in (
                ("01_", ""),
                ("20240512_", ""),
                ("2024-05-12_", ""),
                ("run_2_", ""),
                ("", "run_12_"),
                ("", "03_"),
            )
        ),
        ("1_10mm_0.5Hz_1A", {"amplitude": 0.01, "frequency": 0.5, "current": 1.0}),
        ("10mm_P2_P3_1A", {"amplitude": 0.01, "current": 1.0}),
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


@pytest.mark.parametrize(
    ("stem", "told", "lost"),
    [
        ("25mmpp_2Hz_1A", "'25mmpp' in the name may be the whole stroke", "amplitude"),
        ("25mm_pp_2Hz_1A", "'25mm_pp' in the name may be the whole stroke", "amplitude"),
        ("25 mm pk-pk 2Hz", "'25 mm pk-pk'", "amplitude"),
        ("25MMP2P_2Hz", "'25MMP2P'", "amplitude"),
        ("25mm (pp)_2Hz", "'25mm (pp)'", "amplitude"),
        ("25mm_(p-p)", "'25mm_(p-p)'", "amplitude"),
        ("25mm_ptp_1A", "'25mm_ptp'", "amplitude"),
        ("5mmx_2Hz", "'5mmx' in the name is nearly", "amplitude"),
        ("5mm_2Hzz", "'2Hzz' in the name is nearly", "frequency"),
        ("5mm_250ma", "'250ma' in the name is nearly", "current"),
        ("5mm_1a", "'1a' in the name is nearly", "current"),
        ("5mm_0.5Apeak", "'0.5Apeak' in the name is nearly", "current"),
        ("5mm_250mAmps", "'250mAmps' in the name is nearly", "current"),
        ("5mm_0.2-A", "'0.2-A' in the name is nearly", "current"),
        ("5mm_0.2_A", "Write 0.2A if it is", "current"),
        ("5mm_1_A", "Write 1A if it is", "current"),
        ("5mm 2Hz test 3 A", "'3 A' in the name may be a number with a unit or not", "current"),
        ("1 C", "'1 C' in the name may be", "temperature"),
        ("rig 3 in air", "'3 in' in the name may be", "amplitude"),
        ("rev 1.2 A", "'1.2 A' in the name may be", "current"),
        ("10mm_1Hz_0_5A", "'0_5A' in the name may be 0.5A, or 5A behind a number", "current"),
        ("10mm_1Hz_1_0A", "Write 1.0A if it is that, or tell it in tests.csv", "current"),
        ("10mm_0_25Amp", "'0_25A' in the name may be 0.25A", "current"),
        ("10mm_1Hz_0_5_A", "'0_5_A' in the name may be 0.5A", "current"),
        ("12.5mm_1_5A", "'1_5A' in the name may be 1.5A", "current"),
        ("test_0_5A", "'0_5A' in the name may be 0.5A", "current"),
        ("1_10mm_1Hz_1A", "'1_10mm' in the name may be 1.10mm", "amplitude"),
        ("10mm 2Hz_run 3 A", "'3 A' in the name may be", "current"),
    ],
)  # fmt: skip
def test_what_may_mean_two_things_or_is_nearly_understood_is_told_and_not_taken(stem, told, lost):
    found, notes = conditions_in_name(stem)
    assert lost not in found
    assert len(notes) == 1
    assert told in notes[0]


@pytest.mark.parametrize(
    "token",
    [
        "12Mar",
        "05Mai",
        "10cyc",
        "1.5cycles",
        "1.5kN",
        "0.26mps",
        "0.25ms",
        "100mms",
        "1.0cSt",
        "1umin",
        "2Mat",
        "1max",
        "200Hzfilter",
        "20mmHg",
    ],
)
def test_what_is_no_condition_is_not_nearly_one(token):
    found, notes = conditions_in_name(f"10mm_2Hz_1A_{token}")
    assert found == pytest.approx({"amplitude": 0.01, "frequency": 2.0, "current": 1.0})
    assert notes == ()


def test_each_of_several_that_stand_apart_is_told():
    _, notes = conditions_in_name("10_mm_5_Hz_1_A")
    assert [note.partition(" in the name")[0] for note in notes] == ["'10_mm'", "'5_Hz'", "'1_A'"]


def test_each_underscore_that_may_be_a_decimal_point_is_told():
    """5 mm, 5 Hz and 2 A were read."""
    found, notes = conditions_in_name("12_5mm_1_5Hz_0_2A")
    assert found == {}
    told = [note.partition(" in the name")[0] for note in notes]
    assert told == ["'12_5mm'", "'1_5Hz'", "'0_2A'"]


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
