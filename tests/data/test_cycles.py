"""From records to loops: phase, bins, averaging, harmonics, repeatability."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.data.cycles import cut_loops
from sysid.data.loops import Loops
from sysid.data.phase_grid import phase_average
from sysid.errors import DataError
from tests.data.synthetic import bin_mean, knee_force, make_record

POINTS = 360


@pytest.mark.parametrize(
    ("per_cycle", "limit"),
    [(20.37, 25.0), (39.23, 8.0), (72.13, 2.0), (500.3, 0.1), (4000.7, 0.05)],
)
def test_mean_loop_is_the_bin_mean_at_any_sampling(per_cycle: float, limit: float) -> None:
    record = make_record(frequency=2.0, rate=2.0 * per_cycle, cycles=9.2)
    loops = cut_loops([record]).loops
    error = loops.force[0] - bin_mean(knee_force, POINTS)
    assert np.sqrt(np.mean(error**2)) < limit
    assert loops.cycles[0] == 9


def test_jointly_resampled_cycles_beat_cycles_alone() -> None:
    phase = 0.3 + 2 * np.pi / 39.23 * np.arange(360)
    truth = bin_mean(knee_force, POINTS)
    together = phase_average(phase, knee_force(phase), 20, 9, POINTS).mean(axis=0)
    alone = np.interp(2 * np.pi * (1 + np.arange(POINTS) / POINTS), phase, knee_force(phase))
    assert np.std(together - truth) < 0.2 * np.std(alone - truth)


def test_many_samples_are_averaged() -> None:
    record = make_record(rate=8000.0, cycles=8.3, noise=10.0)
    error = cut_loops([record]).loops.force[0] - bin_mean(knee_force, POINTS)
    samples_per_value = 8 * 4000 / POINTS
    assert np.std(error) == pytest.approx(10.0 / np.sqrt(samples_per_value), rel=0.15)


def test_noise_floor_is_the_scatter_of_one_cycle() -> None:
    """White noise of σ per sample, m samples a bin, leaves σ/√m between cycles."""
    loops = cut_loops([make_record(rate=7200.0, cycles=20.2, noise=10.0)]).loops
    assert loops.noise_floor[0] == pytest.approx(10.0 / np.sqrt(10.0), rel=0.03)
    assert loops.deviations[0].shape == (20, POINTS)
    assert np.abs(loops.deviations[0].mean(axis=0)).max() < 1e-9


def test_one_cycle_has_no_noise_floor() -> None:
    loops = cut_loops([make_record(cycles=1.0, rate=720.0)]).loops
    assert loops.cycles[0] == 1
    assert np.isnan(loops.noise_floor[0])


def test_harmonics_velocity_and_acceleration_are_exact() -> None:
    record = make_record(cycles=9.4, rate=400.0)
    turn = 2 * np.pi * 2.0 * record.time + 0.4
    x = -0.03 + 0.01 * np.sin(turn) + 2e-4 * np.sin(3 * turn + 0.7)
    loops = cut_loops([replace(record, displacement=x)]).loops
    grid = 2 * np.pi * np.arange(POINTS) / POINTS
    w = 4 * np.pi
    assert loops.harmonics[0, 0] == pytest.approx(0.01, rel=1e-6)
    assert abs(loops.harmonics[0, 2]) == pytest.approx(2e-4, rel=1e-4)
    assert np.angle(loops.harmonics[0, 2]) == pytest.approx(0.7, abs=1e-3)
    v = 0.01 * w * np.cos(grid) + 3 * w * 2e-4 * np.cos(3 * grid + 0.7)
    a = -0.01 * w**2 * np.sin(grid) - 9 * w**2 * 2e-4 * np.sin(3 * grid + 0.7)
    np.testing.assert_allclose(loops.velocity[0], v, atol=1e-4 * np.abs(v).max())
    np.testing.assert_allclose(loops.acceleration[0], a, atol=1e-4 * np.abs(a).max())
    assert loops.centre[0] == pytest.approx(-0.03, abs=1e-7)
    assert loops.peak_velocity[0] == pytest.approx(0.01 * w, rel=1e-6)


def test_harmonics_within_noise_are_zero() -> None:
    """Noise in the displacement must not be blown up by differentiating twice."""
    record = make_record(amplitude=0.0016, frequency=5.1, rate=200.0, cycles=9.3)
    rng = np.random.default_rng(5)
    x = record.displacement + rng.normal(0, 5e-6, record.time.size)
    loops = cut_loops([replace(record, displacement=x)]).loops
    assert np.count_nonzero(loops.harmonics[0]) <= 2
    expected = -0.0016 * (2 * np.pi * 5.1) ** 2 * np.sin(2 * np.pi * np.arange(360) / 360)
    error = loops.acceleration[0] - expected
    assert np.sqrt(np.mean(error**2)) < 0.01 * np.abs(expected).max()


def test_deviations_keep_drift() -> None:
    record = make_record(cycles=10.0, rate=2000.0)
    cycle = 2.0 * record.time
    drifting = replace(record, force=record.force * (1 - 0.01 * cycle))
    loops = cut_loops([drifting]).loops
    height = loops.deviations[0] @ loops.force[0] / np.sum(loops.force[0] ** 2)
    slope = np.polyfit(np.arange(height.size), height, 1)[0]
    assert slope == pytest.approx(-0.01 / (1 - 0.01 * 5), rel=0.05)


def test_tests_without_loop_are_left_out_with_the_reason() -> None:
    good = make_record()
    rest = replace(good, id="rest", displacement=np.zeros_like(good.time))
    tare = replace(good, id="tare", nominal=replace(good.nominal, kind="tare"))
    swept = replace(good, id="swept", current=np.linspace(0, 1, good.time.size))
    result = cut_loops([good, rest, tare, swept])
    assert result.loops.ids == ("test",)
    assert set(result.left_out) == {"rest", "tare", "swept"}
    assert "no motion" in result.left_out["rest"]
    assert "tare" in result.left_out["tare"]
    assert "current changes" in result.left_out["swept"]


@pytest.mark.parametrize("rate", [50.0, 1000.0])
def test_a_glitch_or_noise_is_no_change_of_the_current(rate: float) -> None:
    record = make_record(rate=rate)
    rng = np.random.default_rng(0)
    noisy = 0.1 + rng.normal(0.0, 0.012, record.time.size)
    noisy[record.time.size // 2] += 3.0
    assert cut_loops([replace(record, current=noisy)]).loops.ids == ("test",)


def test_a_current_that_steps_or_follows_the_motion_is_refused() -> None:
    record = make_record()
    stepped = np.where(record.time < 2.0, 0.1, 0.3)
    switched = np.where(np.gradient(record.displacement) > 0, 0.1, 0.3)
    for current, how in ((stepped, "from cycle to cycle"), (switched, "within each cycle")):
        (why,) = cut_loops([replace(record, current=current)]).left_out.values()
        assert why.startswith(f"the current changes between 0.1 and 0.3 A {how}")
        assert ("add a column `test`" in why) == (how == "from cycle to cycle")


def test_recorded_current_goes_before_the_label() -> None:
    record = replace(make_record(), current=np.full(make_record().time.size, 0.73))
    assert cut_loops([record]).loops.current[0] == pytest.approx(0.73)
    assert cut_loops([make_record()]).loops.current[0] == pytest.approx(0.5)
    assert np.isnan(cut_loops([make_record(current=None)]).loops.current[0])


def test_no_records_give_empty_loops() -> None:
    loops = cut_loops([]).loops
    assert loops.force.shape == (0, POINTS)
    assert loops.to_frame().empty


def test_equal_ids_are_refused() -> None:
    with pytest.raises(DataError, match="same id"):
        cut_loops([make_record(), make_record()])


def _three() -> Loops:
    records = [replace(make_record(frequency=f), id=f"{f:g}Hz") for f in (1.0, 2.0, 3.0)]
    return cut_loops(records).loops


def test_select_by_mask_and_by_index() -> None:
    loops = _three()
    assert loops.select(np.array([True, False, True])).ids == ("1Hz", "3Hz")
    back = loops.select([2, 0])
    assert back.ids == ("3Hz", "1Hz")
    np.testing.assert_allclose(back.frequency, [3.0, 1.0], rtol=1e-6)
    assert np.array_equal(back.deviations[1], loops.deviations[0])


def test_frame_has_one_row_a_test_with_units() -> None:
    frame = _three().to_frame()
    assert list(frame.index) == ["1Hz", "2Hz", "3Hz"]
    assert frame.loc["2Hz", "frequency_Hz"] == pytest.approx(2.0)
    assert frame.loc["2Hz", "peak_velocity_m/s"] == pytest.approx(0.01 * 4 * np.pi)


def test_cycles_say_at_which_phase_they_begin() -> None:
    """A force that only grows with time is smallest where a cycle begins."""
    rising = make_record(start_phase=2.1, cycles=6.4, force=lambda phase: 100.0 * phase)
    loops = cut_loops([rising]).loops
    assert loops.start_phase is not None
    cycle = loops.force[0] + loops.deviations[0][2]
    begins = 2.0 * np.pi * float(np.argmin(cycle)) / cycle.size
    assert loops.start_phase[0] == pytest.approx(begins, abs=2.0 * np.pi / cycle.size)
    assert begins == pytest.approx(2.1, abs=0.1)
