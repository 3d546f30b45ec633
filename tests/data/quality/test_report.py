"""The report: measured conditions, what to trust, the matrix of what is missing."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sysid.data.campaign import load_campaign
from sysid.data.quality import inspect
from sysid.data.quality.matrix import find_levels
from sysid.data.record import Record
from tests.data.quality.planted import clean, flipped, repaired, report_of, resting


def test_conditions_are_as_measured_not_as_labelled() -> None:
    (test,) = report_of(clean(amplitude=0.0123, frequency=2.2)).tests
    assert test.amplitude == pytest.approx(0.0123, rel=1e-3)
    assert test.frequency == pytest.approx(2.2, rel=1e-4)
    assert test.cycles in (12, 13)
    assert test.noise_floor == pytest.approx(5.0, rel=0.25)
    assert len(test.remarks) == 2


def test_json_entry_has_units_and_no_nan() -> None:
    entry = report_of(clean()).tests[0].to_dict()
    text = json.dumps(entry, allow_nan=False)
    assert {"id", "amplitude_m", "frequency_Hz", "noise_floor_N", "cycles", "faults"} <= set(entry)
    assert json.loads(text)["temperature_degC"] is None


def named(*records: Record) -> tuple[Record, ...]:
    return tuple(replace(record, id=f"t{k}") for k, record in enumerate(records))


def test_a_sound_campaign_is_trusted() -> None:
    assert report_of(*named(clean(), clean(seed=1))).trustworthy


def test_one_rest_file_does_not_spoil_a_campaign() -> None:
    report = report_of(*named(clean(), clean(seed=1), resting(clean())))
    assert report.trustworthy
    assert report.tests[2].fatal
    assert "no motion" in (report.tests[2].left_out or "")


def test_mostly_rest_is_not_trusted() -> None:
    report = report_of(*named(clean(), resting(clean(seed=1)), resting(clean(seed=2))))
    assert not report.trustworthy
    assert "2 of 3 tests have a fatal fault" in report.untrusted[0]


def test_a_wrong_sign_is_not_trusted_and_says_what_to_do() -> None:
    report = report_of(*named(flipped(clean()), flipped(clean(seed=1))))
    assert not report.trustworthy
    assert "use --flip-force" in report.untrusted[0]
    assert "t1" in report.untrusted[0]


def test_where_some_signs_are_right_the_advice_does_not_turn_them() -> None:
    report = report_of(*named(clean(), flipped(clean(seed=1))))
    assert not report.trustworthy
    assert "--exclude (the manifest and --flip-force turn every test)" in report.untrusted[0]


def test_one_wrong_sign_of_many_is_left_out_and_the_rest_is_trusted() -> None:
    report = report_of(*named(clean(), clean(seed=1), flipped(clean(seed=2))))
    assert report.trustworthy
    assert report.tests[2].fatal


def test_what_was_done_to_the_numbers_is_told() -> None:
    entry = report_of(repaired(clean())).tests[0].to_dict()
    assert entry["changes"] == [
        "time stamps repeat in 3 of 1000 rows: the rows that repeat one were left out"
    ]


def test_declared_tare_and_rod_tests_are_no_faults() -> None:
    tare = replace(resting(clean()), nominal=replace(clean().nominal, kind="tare"))
    report = report_of(*named(clean(), tare))
    assert report.trustworthy
    assert report.tests[1].faults == ()
    assert report.tests[1].left_out == "declared as tare, not as sine"


def test_matrix_shows_what_is_missing() -> None:
    tests = [(0.01, 1.0, 0.0), (0.01, 1.0, 0.5), (0.01, 2.0, 0.0), (0.0101, 1.01, 0.0)]
    records = named(*(clean(amplitude=a, frequency=f, current=i) for a, f, i in tests))
    matrix = report_of(*records).matrix()
    assert len(matrix) == 4
    missing = matrix[matrix["tests"] == 0]
    assert len(missing) == 1
    assert missing["frequency_Hz"].iloc[0] == pytest.approx(2.0, rel=0.01)
    assert missing["current_A"].iloc[0] == 0.5
    assert sorted(matrix["tests"]) == [0, 1, 1, 2]
    assert "t0, t3" in list(matrix["ids"])


def test_levels_group_what_is_close() -> None:
    levels, member = find_levels(np.array([2.0, 1.0, np.nan, 1.01, 1.0]), 0.05, 0.0)
    np.testing.assert_allclose(levels, [1.0, 2.0, np.nan])
    assert member.tolist() == [1, 0, 2, 0, 0]


@pytest.mark.parametrize(
    ("settings", "relative", "absolute", "scatter"),
    [((20.0, 25.0, 30.0), 0.0, 5.0, 1.0), ((0.0, 0.02, 0.04, 0.06), 0.05, 0.02, 1e-3)],
    ids=["every 5 °C", "every 20 mA"],
)
def test_settings_no_further_apart_than_the_tolerance_are_levels(
    settings: tuple[float, ...], relative: float, absolute: float, scatter: float
) -> None:
    rng = np.random.default_rng(5)
    values = np.repeat(settings, 8) + rng.uniform(-scatter, scatter, 8 * len(settings))
    levels, member = find_levels(values, relative, absolute)
    np.testing.assert_allclose(levels, settings, atol=scatter)
    assert member.tolist() == np.repeat(np.arange(len(settings)), 8).tolist()


def test_a_sweep_has_no_levels() -> None:
    levels, member = find_levels(np.linspace(11.0, 75.0, 194), 0.0, 5.0)
    assert levels.size == 1
    assert not member.any()


def test_labels_tell_the_levels_of_what_scatters() -> None:
    """A missing pair of temperature and current is seen, which a chain of temperatures hid."""
    rng = np.random.default_rng(6)
    tests = [(t, i) for t in (20.0, 25.0, 30.0) for i in (0.0, 0.5, 1.0) if (t, i) != (25.0, 0.5)]
    records = []
    for k, (t, i) in enumerate(tests):
        record = clean(seed=k, current=i)
        warm = np.full(record.time.size, t + rng.uniform(-3.0, 3.0))
        nominal = replace(record.nominal, temperature=t)
        records.append(replace(record, temperature=warm, nominal=nominal))
    matrix = report_of(*named(*records)).matrix()
    assert len(matrix) == 9
    missing = matrix[matrix["tests"] == 0]
    assert missing[["temperature_degC", "current_A"]].to_numpy().tolist() == [[25.0, 0.5]]


def test_utfsm_dropouts_and_conditions(utfsm_folder: Path, utfsm_manifest: Path) -> None:
    """The two tests with drop-outs, and no other; true frequencies and amplitudes."""
    report = inspect(load_campaign(utfsm_folder, utfsm_manifest))
    assert len(report.tests) == 20
    flagged = {t.id for t in report.tests if any(f.kind == "dropout" for f in t.faults)}
    assert flagged == {"25mm0x25Hz_0x75A", "25mm0x25Hz_1A"}
    assert report.trustworthy
    expected = {
        "2mm5Hz": (1.645e-3, 5.101),
        "5mm3Hz": (4.62e-3, 3.051),
        "25mm0x25Hz": (24.9e-3, 0.255),
        "25mm0x5Hz": (24.9e-3, 0.5095),
    }
    for test in report.tests:
        amplitude, frequency = expected[test.id.split("_")[0]]
        assert test.amplitude == pytest.approx(amplitude, rel=3e-3), test.id
        assert test.frequency == pytest.approx(frequency, rel=1e-3), test.id
        assert test.centre == pytest.approx(-0.0299, abs=1e-4), test.id
        assert test.noise_floor is not None
        limit = 0.035 if test.id in flagged else 0.03
        assert 0.004 < test.noise_floor / test.peak_force < limit, test.id
    small = [t for t in report.tests if t.id.startswith("2mm")]
    kinds = {(f.kind, f.severity) for test in small for f in test.faults}
    assert ("amplitude_mislabelled", "warning") in kinds
    assert ("frequency_mislabelled", "note") in kinds
    matrix = report.matrix()
    assert int((matrix["tests"] > 0).sum()) == 20
    assert len(matrix) == 3 * 4 * 5
