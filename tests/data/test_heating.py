"""Tests recorded while the damper heats or cools, cut into parts."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sysid.data.campaign import Campaign, load_campaign
from sysid.data.cycles import cut_loops, find_steady
from sysid.data.heating import FEWEST_CYCLES, cut_by_temperature, whole_test
from sysid.data.manifest import Manifest, read_manifest
from sysid.data.quality import inspect
from sysid.data.record import Record
from sysid.data.split import hold_out
from sysid.errors import ManifestError
from tests.data.synthetic import make_record

RATE = 400.0


def _record(warm, cycles: float = 60.0, noise: float = 0.0, **labels) -> Record:
    """A test at 2 Hz with a temperature over the share of its time (`warm`: share → °C)."""
    record = make_record(cycles=cycles, rate=RATE, ramp=1.0, rest=0.2, noise=3.0, **labels)
    share = record.time / record.time[-1]
    jitter = np.random.default_rng(5).normal(0.0, noise, share.size) if noise else 0.0
    return replace(record, temperature=warm(share) + jitter)


def _rising(low: float, high: float):
    return lambda share: low + (high - low) * share


def _spans(parts: tuple[Record, ...]) -> list[float]:
    """K by which it moves in the whole steady cycles of each part."""
    spans = []
    for part in parts:
        steady = find_steady(part)
        assert part.temperature is not None
        inside = part.temperature[steady.start : steady.stop][steady.sample_cycle >= 0]
        spans.append(float(np.ptp(inside)))
    return spans


def test_a_heating_record_is_cut_into_even_parts_and_nothing_is_lost() -> None:
    record = _record(_rising(15.0, 75.0))
    parts, said = cut_by_temperature(record, 5.0)
    steady = find_steady(record)
    assert len(parts) == 12
    assert sum(find_steady(part).cycles for part in parts) == steady.cycles
    assert max(_spans(parts)) < 5.0 * 1.02
    assert min(find_steady(part).cycles for part in parts) >= 4
    # every sample is in a part, in order; a little is in two
    time = np.concatenate([part.time for part in parts])
    np.testing.assert_array_equal(np.unique(time), record.time)
    assert (parts[0].time[0], parts[-1].time[-1]) == (record.time[0], record.time[-1])
    shared = time.size - record.time.size
    assert shared / (len(parts) - 1) < 0.11 * RATE / 2.0
    assert said is not None
    assert "cut into 12 parts" in said
    assert f"in {steady.cycles} steady cycles" in said


def test_names_and_conditions_are_the_mean_temperatures() -> None:
    record = _record(_rising(15.0, 75.0), temperature=20.0, run_order=7)
    parts, _ = cut_by_temperature(record, 5.0)
    loops = cut_loops(parts).loops
    assert len(set(loops.ids)) == len(parts)
    for part, warm in zip(parts, loops.temperature, strict=True):
        told = float(part.id.removeprefix("test@").removesuffix("C"))
        assert part.nominal.temperature == pytest.approx(told, abs=0.0501)
        assert warm == pytest.approx(told, abs=0.3)
        assert whole_test(part.id) == "test"
        assert part.nominal.run_order == 7
        assert part.source.part == part.id.removeprefix("test@")
        assert "cut by temperature (the temperature goes from" in part.source.changes[-1]


def test_a_loop_of_a_part_is_that_of_its_cycles_in_the_whole_record() -> None:
    """Force that falls with temperature: each part shows its own."""
    record = _record(_rising(15.0, 75.0))
    assert record.temperature is not None
    record = replace(record, force=record.force * (1.0 - 0.005 * (record.temperature - 15.0)))
    loops = cut_loops(cut_by_temperature(record, 5.0)[0]).loops
    peak = np.max(loops.force, axis=1)
    assert (np.diff(peak) < 0.0).all()
    expected = 1.0 - 0.005 * (loops.temperature - 15.0)
    np.testing.assert_allclose(peak / expected, np.mean(peak / expected), rtol=0.01)


def test_cooling_and_turning() -> None:
    cooling, _ = cut_by_temperature(_record(_rising(75.0, 15.0)), 5.0)
    warm = [part.nominal.temperature for part in cooling]
    assert len(cooling) == 12
    assert warm == sorted(warm, reverse=True)
    there_and_back, _ = cut_by_temperature(
        _record(lambda s: 40.0 + 12.0 * np.minimum(2 * s, 2 - 2 * s)), 5.0
    )
    assert max(_spans(there_and_back)) < 5.0 * 1.1
    assert len({part.id for part in there_and_back}) == len(there_and_back)


def test_parts_at_the_same_temperature_have_names_of_their_own() -> None:
    parts, _ = cut_by_temperature(
        _record(lambda s: np.where((s < 0.25) | (s > 0.75), 20.0, 40.0), cycles=40.0), 5.0
    )
    names = [part.id for part in parts]
    assert len(set(names)) == len(names)
    assert "test@20.0C" in names
    assert "test@20.0C_2" in names
    assert whole_test("test@20.0C_2") == "test"


@pytest.mark.parametrize(
    "warm",
    [_rising(20.0, 24.0), lambda share: 0.0 * share + 40.0],
    ids=["little drift", "none"],
)
def test_a_test_that_hardly_warms_stays_whole(warm) -> None:
    record = _record(warm)
    assert cut_by_temperature(record, 5.0) == ((record,), None)


def test_noise_alone_cuts_nothing_and_hides_no_drift() -> None:
    noisy = _record(_rising(40.0, 41.0), noise=15.0)
    assert np.ptp(np.asarray(noisy.temperature)) > 50.0
    assert cut_by_temperature(noisy, 5.0) == ((noisy,), None)
    heating = _record(_rising(15.0, 75.0), noise=15.0)
    parts, _ = cut_by_temperature(heating, 5.0)
    assert 11 <= len(parts) <= 15
    warm = np.array([part.nominal.temperature for part in parts])
    assert (np.diff(warm) > 2.0).all()
    assert sum(find_steady(part).cycles for part in parts) == find_steady(heating).cycles


def test_too_few_cycles() -> None:
    record = _record(_rising(15.0, 75.0), cycles=5.0)
    parts, said = cut_by_temperature(record, 5.0)
    assert parts == (record,)
    assert said is not None
    assert "too few to be cut by temperature; it stays one test" in said
    fast, said = cut_by_temperature(_record(_rising(15.0, 75.0), cycles=20.0), 5.0)
    assert [find_steady(part).cycles >= FEWEST_CYCLES for part in fast] == [True] * len(fast)
    assert len(fast) == 6
    assert said is not None
    assert "in 6 of them it still moves by more than 5 K" in said
    report = inspect(Campaign("c", Path(), fast, Manifest()))
    for test in report.tests:
        assert [f.severity for f in test.faults if f.kind == "temperature_drift"] == ["warning"]


def test_without_temperature_or_without_a_steady_part_there_is_nothing_to_cut() -> None:
    record = _record(_rising(15.0, 75.0))
    blind = replace(record, temperature=None)
    other = replace(record, nominal=replace(record.nominal, kind="random"))
    rest = replace(record, displacement=0.0 * record.displacement)
    for untouched in (blind, other, rest):
        assert cut_by_temperature(untouched, 5.0) == ((untouched,), None)


# ---- in a campaign -----------------------------------------------------------------------------


def _write(folder: Path, name: str, record: Record, manifest: str = "") -> Path:
    folder.mkdir(exist_ok=True)
    columns = [record.time, 1e3 * record.displacement, record.force, np.asarray(record.temperature)]
    np.savetxt(
        folder / f"{name}.csv",
        np.column_stack(columns),
        delimiter=",",
        fmt="%.5f",
        header="time_s,displacement_mm,force_N,temperature_degC",
        comments="",
    )
    if manifest:
        (folder / "campaign.toml").write_text(manifest)
    return folder


def test_a_folder_is_read_in_parts_by_default_and_says_so(tmp_path: Path) -> None:
    record = _record(_rising(20.0, 32.0), cycles=30.0)
    folder = _write(tmp_path / "c", "10mm_2Hz_1A", record)
    (folder / "tests.csv").write_text("file,run_order\n10mm_2Hz_1A.csv,4\n")
    campaign = load_campaign(folder)
    assert len(campaign.records) == 3
    assert {record.nominal.current for record in campaign.records} == {1.0}
    assert {record.nominal.run_order for record in campaign.records} == {4}
    assert len(campaign.notes) == 1
    assert "10mm_2Hz_1A: the temperature goes from" in campaign.notes[0]
    assert "sweeps.cut = false" in campaign.notes[0]
    report = inspect(campaign)
    assert [test.left_out for test in report.tests] == [None] * 3
    drifts = {f.severity for test in report.tests for f in test.faults}
    assert drifts == {"note"}


def test_the_manifest_sets_the_step_or_leaves_tests_whole(tmp_path: Path) -> None:
    record = _record(_rising(20.0, 32.0), cycles=30.0)
    folder = _write(tmp_path / "c", "10mm_2Hz_1A", record, "[sweeps]\ncut = false\n")
    whole = load_campaign(folder)
    assert [r.id for r in whole.records] == ["10mm_2Hz_1A"]
    assert whole.notes == ()
    drift = [f for f in inspect(whole).tests[0].faults if f.kind == "temperature_drift"]
    assert drift[0].severity == "warning"
    for step, count in (
        ('{ value = 2, unit = "K" }', 6),
        ('{ value = 4.0, unit = "degC" }', 3),
        ('{ value = 10.8, unit = "degF" }', 2),
        ('{ value = 20, unit = "K" }', 1),
    ):
        (folder / "campaign.toml").write_text(f"[sweeps]\nstep = {step}\n")
        assert len(load_campaign(folder).records) == count


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ('step = { value = 0, unit = "K" }', "sweeps.step must be positive"),
        ('step = { value = -2, unit = "K" }', "sweeps.step must be positive"),
        ('step = { value = 5, unit = "mm" }', "mm"),
        ('cut = "no"', "sweeps.cut = 'no' is refused"),
        ("width = 5", "key 'sweeps.width' is not known"),
    ],
)
def test_a_wrong_manifest_is_refused(tmp_path: Path, written: str, said: str) -> None:
    path = tmp_path / "campaign.toml"
    path.write_text(f"[sweeps]\n{written}\n")
    with pytest.raises(Exception, match=said) as caught:
        read_manifest(path)
    assert "line 2" in str(caught.value) or isinstance(caught.value, ManifestError)


def test_globs_for_the_file_match_all_of_its_parts() -> None:
    ids = ("a_1A@15.2C", "a_1A@20.1C_2", "b_1A", "run@night", "c#2@-5.0C")
    assert hold_out(ids, ["a_1A"]).tolist() == [True, True, False, False, False]
    assert hold_out(ids, ["*_1A"]).tolist() == [True, True, True, False, False]
    assert hold_out(ids, ["*@15*"]).tolist() == [True, False, False, False, False]
    assert hold_out(ids, ["c#2", "run@night"]).tolist() == [False, False, False, True, True]


def test_what_lies_beyond_a_gap_in_time_is_in_no_part() -> None:
    """It is warmer there than the part before the gap would be called."""
    whole = _record(_rising(15.0, 75.0))
    kept = np.delete(np.arange(whole.time.size), np.s_[8000:8300])
    assert whole.temperature is not None
    record = replace(
        whole,
        time=whole.time[kept], displacement=whole.displacement[kept], force=whole.force[kept],
        temperature=whole.temperature[kept],
    )  # fmt: skip
    parts, said = cut_by_temperature(record, 5.0)
    assert max(part.time[-1] for part in parts) == record.time[7999]
    assert said is not None
    assert f"{record.time.size - 8000} samples beyond a gap in time" in said
    for part in parts:
        steady = find_steady(part)
        assert part.temperature is not None
        inside = float(np.mean(part.temperature[steady.start : steady.stop]))
        assert inside == pytest.approx(part.nominal.temperature, abs=0.5)
