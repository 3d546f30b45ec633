"""Each stage is exact on loops of straight lines, says what it used, and how surely."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.identification.straight_lines.recipes import straight_line_fits
from sysid.identification.straight_lines.stage import Reading, Stage
from sysid.identification.straight_lines.windows import Window, Windows
from tests.identification.straight_lines.straight_loops import laws, sweep_loops, with_noise


@pytest.fixture(scope="module")
def loops():
    return sweep_loops()


@pytest.fixture(scope="module")
def found(loops):
    return straight_line_fits(loops)


def values(stage: Stage) -> np.ndarray:
    return np.array([r.value for r in stage.readings])


def truth(stage: Stage, which: int) -> np.ndarray:
    return np.array([laws(r.current, r.temperature)[which] for r in stage.readings])


def test_straight_loops_give_back_what_they_were_made_of(found):
    for which, stage in enumerate((found.viscosity, found.yield_force, found.stiffness)):
        assert not stage.left_out
        np.testing.assert_allclose(values(stage), truth(stage, which), rtol=1e-9)
        assert max(abs(r.offset - 25.0) for r in stage.readings) < 1e-7
    assert [len(s.readings) for s in (found.viscosity, found.yield_force)] == [15, 15]


def test_lines_against_temperature_are_the_laws(found):
    for lines, which in ((found.viscosity_lines, 0), (found.yield_lines, 1)):
        assert [z.current for z in lines] == [0.0, 0.8, 1.0]
        for one in lines:
            cold, hot = laws(one.current, 0.0)[which], laws(one.current, 10.0)[which]
            assert one.line.intercept == pytest.approx(cold, rel=1e-7)
            assert one.line.slope == pytest.approx((hot - cold) / 10.0, abs=1e-7 * cold)
    line = found.stiffness_line.line
    assert (line.intercept, line.slope) == pytest.approx((1.5e6, 1.5e5), rel=1e-7)
    change = line.change(15.0, 75.0)
    assert change.percent == pytest.approx(240.0, abs=1e-4)
    assert found.offset_line.line.intercept == pytest.approx(25.0, abs=1e-6)


def test_points_used_are_those_of_the_window(loops, found):
    """Decelerating, at 10–90 % and 30–90 % of peak speed; after reversal for k; both directions."""
    for stage, low in ((found.viscosity, 0.1), (found.yield_force, 0.3)):
        for r in stage.readings:
            share = np.abs(loops.velocity[r.test]) / loops.peak_velocity[r.test]
            slows = loops.velocity[r.test] * loops.acceleration[r.test] < 0.0
            expected = slows & (share > low) & (share < 0.9)
            np.testing.assert_array_equal(r.used, expected)
    for r in found.stiffness.readings:
        v, x = loops.velocity[r.test, r.used], loops.displacement[r.test, r.used]
        assert (v * x < 0.0).all()
        force = np.sign(x) * (loops.force[r.test, r.used] - 25.0)
        yields = laws(r.current, r.temperature)[1]
        way = (yields - force) / (2.0 * yields)
        assert 0.1 < way.min() < 0.2
        assert 0.5 < way.max() < 0.6
        assert abs((x > 0.0).sum() - (x < 0.0).sum()) <= 1


def test_windows_are_arguments_and_their_spread_is_zero_on_straight_lines(loops, found):
    other = Windows(Window(0.5, 0.8), Window(0.4, 0.7), Window(0.2, 0.9))
    moved = straight_line_fits(loops, windows=other)
    for stage, changed in (
        (found.viscosity, moved.viscosity),
        (found.yield_force, moved.yield_force),
        (found.stiffness, moved.stiffness),
    ):
        np.testing.assert_allclose(values(changed), values(stage), rtol=1e-8)
        pairs = zip(stage.readings, changed.readings, strict=True)
        assert all((a.used != b.used).any() for a, b in pairs)
        assert stage.readings[0].choices.size == len(stage.grid) > 10
        assert stage.spread < 1e-8


def test_choice_of_points_matters_on_bent_loops(loops):
    """Force that bends with speed: slopes at high speed are smaller, and the spread says so."""
    v = loops.velocity
    bent = replace(loops, force=loops.force - 400.0 * np.sign(v) * v**2)
    stage = straight_line_fits(bent).viscosity
    reading = stage.readings[0]
    by_window = dict(zip(stage.grid, reading.choices, strict=True))
    assert by_window[Window(0.5, 0.9)] < by_window[Window(0.1, 0.7)] - 50.0
    assert reading.spread == pytest.approx(reading.choices.std(ddof=1), rel=1e-12)
    assert stage.spread > 0.02


@pytest.fixture(scope="module")
def repeated() -> tuple[list[list[list[Reading]]], list[np.ndarray]]:
    """Three stages of one test of each kind, over draws of noise with a memory of points."""
    clean = sweep_loops(currents=(1.0,), temperatures=(15.0,))
    rng = np.random.default_rng(8)
    none = Windows(post_grid=(), yield_grid=(), stiffness_grid=())
    readings: list[list[list[Reading]]] = [[], [], []]
    for _ in range(150):
        noisy = with_noise(clean, rng, 30.0, 6, memory=0.95)
        found = straight_line_fits(noisy, windows=none)
        for k, stage in enumerate((found.viscosity, found.yield_force, found.stiffness)):
            readings[k].append(list(stage.readings))
    return readings, [np.array(laws(1.0, 15.0))]


def test_standard_errors_are_honest_where_neighbouring_points_agree(repeated):
    """Points 0.95 correlated: least squares would claim a third of the error."""
    readings, (true,) = repeated
    for k in range(3):
        value = np.array([r[0].value for r in readings[k]])
        se = np.array([r[0].se for r in readings[k]])
        assert {r[0].replicates for r in readings[k]} == {6}
        claimed, seen = np.sqrt((se**2).mean()), value.std(ddof=1)
        assert 0.8 < claimed / seen < 1.2
        assert abs(value.mean() - true[k]) < 0.02 * true[k]


def test_without_repetition_directions_are_the_repetitions(loops):
    """C_post and k have two directions; what differs between those of F_y is the offset."""
    softer = np.where(loops.velocity < 0.0, loops.force * 0.9, loops.force)
    found = straight_line_fits(replace(loops, force=softer))
    first = found.viscosity.readings[0]
    assert (first.replicates, first.se) == (2, abs(first.half_difference))
    assert first.half_difference == pytest.approx(first.value * 0.1 / 1.9, rel=1e-6)
    assert np.isnan(found.yield_force.readings[0].se)


def test_a_test_that_cannot_be_read_says_why():
    """No force that falls after reversal, and hardly any points."""
    loops = sweep_loops(temperatures=(15.0, 75.0))
    upside_down = replace(loops, force=-loops.force)
    found = straight_line_fits(upside_down)
    assert not found.viscosity.readings
    assert "slope is no viscosity" in found.viscosity.left_out["test0"]
    assert "no force that resists motion" in next(iter(found.yield_force.left_out.values()))
    assert found.undetermined[0].startswith("C_post is not determined: force falls with speed")
    narrow = Windows(stiffness=Window(0.5, 0.501))
    told = straight_line_fits(loops, windows=narrow).stiffness.left_out
    assert all("a line needs 3" in why for why in told.values())
    assert len(told) == 4


@pytest.mark.parametrize(("low", "high"), [(0.9, 0.1), (-0.1, 0.5), (0.5, 1.2), (0.5, 0.5)])
def test_windows_that_are_none_are_refused(low, high):
    with pytest.raises(ValueError, match="0 ≤ low < high ≤ 1"):
        Window(low, high)
