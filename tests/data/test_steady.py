"""The steady part: true frequency and amplitude from the displacement alone."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.data.cycles import cut_loop
from sysid.data.record import Record
from sysid.data.steady import NoSteadyPartError, find_steady
from tests.data.synthetic import knee_force, make_record


@pytest.mark.parametrize("per_cycle", [20.3, 39.2, 500.0, 4000.0])
@pytest.mark.parametrize("frequency", [0.25, 5.101])
def test_frequency_amplitude_and_centre_are_exact(per_cycle: float, frequency: float) -> None:
    steady = find_steady(make_record(frequency=frequency, rate=per_cycle * frequency))
    assert steady.frequency == pytest.approx(frequency, rel=1e-6)
    assert steady.amplitude == pytest.approx(0.01, rel=1e-6)
    assert steady.centre == pytest.approx(-0.03, abs=1e-8)
    assert steady.phase[0] == pytest.approx(0.4, abs=1e-5)
    assert steady.cycles == 8


def test_wrong_labels_do_not_matter() -> None:
    right = find_steady(make_record())
    wrong = find_steady(make_record(amplitude=0.01, frequency=2.0, current=9.0))
    mislabelled = make_record()
    nominal = replace(mislabelled.nominal, amplitude=0.5, frequency=77.0)
    other = find_steady(replace(mislabelled, nominal=nominal))
    assert right.frequency == wrong.frequency == other.frequency
    assert np.array_equal(right.phase, other.phase)


def test_no_other_test_is_sought_in_ramps(monkeypatch) -> None:
    """Every test of every campaign has some, and to seek takes three times as long as to cut."""

    def sought(*_: object) -> None:
        raise AssertionError

    monkeypatch.setattr("sysid.data.other_motions._steady_in", sought)
    steady = find_steady(make_record(ramp=0.75, rest=1.0, cycles=4.0))
    assert steady.others == ()
    with pytest.raises(AssertionError):  # more than a third of the travel
        find_steady(make_record(ramp=8.0, cycles=4.0))


def test_ramps_and_rest_are_left_out_and_said() -> None:
    record = make_record(ramp=2.0, rest=3.0, cycles=6.0)
    steady = find_steady(record)
    inside = record.time[steady.start], record.time[steady.stop - 1]
    period = 0.5
    assert 4.0 - 0.05 * period <= inside[0] <= 4.0 + 0.2 * period
    assert 7.0 - 0.2 * period <= inside[1] <= 7.0 + 0.05 * period
    assert steady.amplitude == pytest.approx(0.01, rel=1e-3)
    assert steady.time_since_rest[0] == pytest.approx(inside[0] - 3.0, abs=0.05)
    assert len(steady.left_out) == 2
    assert all("left out" in text for text in steady.left_out)
    assert str(steady.start) in steady.left_out[0]


def test_slow_wander_of_the_frequency_is_followed() -> None:
    time = np.arange(0.0, 10.0, 0.002)
    phase = 2 * np.pi * (2.0 * time + 0.03 * np.sin(2 * np.pi * 0.1 * time))
    x = 0.01 * np.sin(phase)
    steady = find_steady(Record("wander", time, x, np.cos(phase)))
    true = phase[steady.start : steady.stop]
    error = steady.phase - true
    assert np.ptp(error[500:-500]) < 0.01
    assert np.ptp(error) < 0.05


def test_exactly_one_cycle_is_one_cycle() -> None:
    steady = find_steady(make_record(cycles=1.0, rate=720.0, frequency=2.0))
    assert steady.cycles == 1
    assert steady.frequency == pytest.approx(2.0, rel=2e-3)


@pytest.mark.parametrize("cycles", [2.0, 3.0, 5.0])
@pytest.mark.parametrize("rate", [44.0, 720.0, 1000.0])
def test_a_record_of_whole_cycles_gives_all_of_them(cycles: float, rate: float) -> None:
    """The windows end with the record, not with the last sixteenth of a cycle before its end."""
    steady = find_steady(make_record(cycles=cycles, rate=rate, frequency=2.0))
    assert steady.cycles == cycles
    assert steady.left_out == ()


def test_sample_cycles_count_whole_cycles() -> None:
    steady = find_steady(make_record(cycles=3.5))
    index = steady.sample_cycle
    assert index.min() == -1
    assert all(abs(int(np.sum(index == k)) - 500) <= 1 for k in range(3))
    assert np.all(np.diff(index[index >= 0]) >= 0)


def test_a_noisy_quantised_motion_is_found() -> None:
    record = make_record(amplitude=0.0016, frequency=5.1, rate=200.0, ramp=1.0, rest=1.0)
    rng = np.random.default_rng(1)
    x = np.round((record.displacement + rng.normal(0, 5e-6, record.time.size)) / 3e-6) * 3e-6
    steady = find_steady(replace(record, displacement=x))
    assert steady.frequency == pytest.approx(5.1, rel=1e-3)
    assert steady.amplitude == pytest.approx(0.0016, rel=5e-3)


def _record(x: np.ndarray, rate: float = 500.0) -> Record:
    time = np.arange(x.size) / rate
    return Record("t", time, x, np.zeros_like(x))


def _bad() -> dict[str, tuple[Record, str]]:
    rng = np.random.default_rng(3)
    white = rng.normal(0, 1, 10000)
    kernel = np.exp(-0.5 * (np.arange(-200, 201) / 40.0) ** 2)
    smooth = np.convolve(white, kernel, "same") / np.sqrt(np.sum(kernel**2))
    t = np.arange(5000) / 500.0
    triangle = 0.02 * np.abs((2.0 * t) % 1.0 - 0.5)
    gap = make_record().displacement.copy()
    gap[100] = np.nan
    return {
        "random": (_record(0.01 * smooth), "not_sinusoidal"),
        "rest": (_record(1e-7 * white), "rest_only"),
        "noisy rest": (_record(1e-4 * white), "rest_only"),
        "constant": (_record(np.full(1000, 0.01)), "rest_only"),
        "triangle": (_record(triangle), "not_sinusoidal"),
        "two thirds": (_record(0.01 * np.sin(2 * np.pi * 0.066 * t)), "too_few_cycles"),
        "step": (_record(0.01 * (t > 5)), "too_few_cycles"),
        "nan": (_record(gap), "not_finite"),
        "six a cycle": (_record(0.01 * np.sin(2 * np.pi * 83.0 * t)), "undersampled"),
    }


@pytest.mark.parametrize("name", _bad())
def test_motion_without_a_steady_cycle_says_why(name: str) -> None:
    record, reason = _bad()[name]
    with pytest.raises(NoSteadyPartError) as caught:
        find_steady(record)
    assert caught.value.reason == reason, caught.value.what


def _without(record: Record, first: int, last: int) -> Record:
    """The record as if nothing had been recorded between two samples."""
    kept = np.delete(np.arange(record.time.size), np.s_[first:last])
    return replace(
        record,
        time=record.time[kept], displacement=record.displacement[kept], force=record.force[kept],
    )  # fmt: skip


@pytest.mark.parametrize(("first", "last"), [(700, 800), (900, 1400), (600, 640)])
def test_no_cycle_goes_across_a_gap_in_time(first: int, last: int) -> None:
    """Half a cycle, two and a half, and a fifth of one are missing."""
    whole = make_record(cycles=8.0, rate=400.0, frequency=2.0, noise=3.0)
    record = _without(whole, first, last)
    steady = find_steady(record)
    assert np.diff(record.time[steady.start : steady.stop]).max() < 0.003
    assert steady.cycles == 4
    assert steady.frequency == pytest.approx(2.0, rel=1e-6)
    assert any("beside a gap in time" in text for text in steady.left_out)
    loop = cut_loop(record, steady)
    assert loop.noise_floor == pytest.approx(
        cut_loop(whole, find_steady(whole)).noise_floor, rel=0.1
    )


def test_another_test_in_the_same_record_is_told_and_does_not_leak_in() -> None:
    """The second's first sample lies on the loop of the first, with a force of the second."""
    parts = [
        make_record(frequency=f, cycles=6.0, rate=200.0, start_phase=0.0, seed=int(f), force=force)
        for f, force in ((1.0, knee_force), (3.0, lambda phase: 3.0 * knee_force(phase)))
    ]
    x, force = (np.concatenate([getattr(r, z) for r in parts]) for z in ("displacement", "force"))
    record = replace(parts[0], time=np.arange(x.size) / 200.0, displacement=x, force=force)
    steady = find_steady(record)
    assert steady.stop <= parts[0].time.size
    assert steady.cycles == 5
    (other,) = steady.others
    assert "cycles of 10 mm at 3 Hz after the steady part" in other
    assert "a motion of its own" in steady.left_out[-1]
    assert find_steady(parts[0]).others == ()


def test_long_ramps_are_no_other_test() -> None:
    assert find_steady(make_record(cycles=5.0, ramp=4.0, rest=1.0)).others == ()


def test_a_few_samples_that_are_missing_are_no_gap() -> None:
    steady = find_steady(_without(make_record(cycles=8.0, rate=400.0, frequency=2.0), 620, 625))
    assert (steady.cycles, steady.left_out) == (8, ())


def test_gaps_in_every_cycle_leave_nothing_and_say_so() -> None:
    record = make_record(cycles=6.0, rate=400.0, frequency=2.0)
    for cycle in range(6):
        record = _without(record, 160 * cycle + 60, 160 * cycle + 100)
    with pytest.raises(NoSteadyPartError, match="gaps in time") as caught:
        find_steady(record)
    assert caught.value.reason == "undersampled"
