"""Which tests the recipes take, what a campaign may lack, what is said and drawn."""

from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from sysid.cli.console import Talk
from sysid.cli.straight_line_tables import bias_table, line_table, show_straight_lines
from sysid.data.campaign import load_campaign
from sysid.data.cycles import cut_loops
from sysid.errors import FitError
from sysid.identification.straight_lines.bias import Bias
from sysid.identification.straight_lines.model_loops import recipe_bias, with_force
from sysid.identification.straight_lines.recipes import lines_without, straight_line_fits
from sysid.identification.straight_lines.words import sentences
from sysid.report.straight_lines_plot import (
    plot_against_temperature,
    plot_points_used,
    straight_lines_png,
)
from tests.identification.straight_lines.straight_loops import (
    FAST,
    SLOW,
    laws,
    sweep_loops,
    with_noise,
)


@pytest.fixture(scope="module")
def loops():
    return with_noise(sweep_loops(), np.random.default_rng(1), 10.0, 5)


@pytest.fixture(scope="module")
def found(loops):
    return straight_line_fits(loops)


def excitation_of(loops, stage) -> tuple[float, float]:
    tests = [r.test for r in stage.readings]
    assert np.ptp(loops.amplitude[tests]) == 0.0
    return loops.amplitude[tests[0]], loops.frequency[tests[0]]


def test_the_papers_excitations_are_taken_where_others_are_faster():
    loops = sweep_loops(excitations=((0.02, 4.0), FAST, SLOW, (0.0025, 8.0), (0.02, 8.0)))
    found = straight_line_fits(loops)
    assert excitation_of(loops, found.viscosity) == FAST
    assert excitation_of(loops, found.yield_force) == SLOW
    assert excitation_of(loops, found.stiffness) == FAST
    assert found.viscosity.rule == "10 mm at 8 Hz, the paper's"
    assert {r.current for r in found.stiffness.readings} == {0.8, 1.0}


def test_amplitudes_and_currents_off_nominal_are_the_same_condition():
    loops = sweep_loops()
    rng = np.random.default_rng(3)
    current = loops.current * (1.0 + 0.005 * rng.standard_normal(loops.current.size))
    amplitude = loops.amplitude * (0.93 + 0.02 * rng.random(loops.current.size))
    ratio = (amplitude / loops.amplitude)[:, None]
    current[loops.current == 0.0] = -1e-5
    off = replace(
        loops,
        amplitude=amplitude,
        current=current,
        displacement=loops.displacement * ratio,
        velocity=loops.velocity * ratio,
    )
    found = straight_line_fits(off)
    assert [len(z.line.value) for z in found.viscosity_lines] == [5, 5, 5]
    assert found.stiffness_line.current == pytest.approx(1.0, abs=0.01)
    assert "1e-05" not in shown(line_table(found))


def test_elsewhere_the_rule_is_declared():
    others = ((0.020, 5.0), (0.010, 2.5), (0.005, 1.0))
    loops = sweep_loops(currents=(0.0, 0.2, 0.4), excitations=others)
    found = straight_line_fits(loops)
    assert excitation_of(loops, found.viscosity) == others[0]
    assert excitation_of(loops, found.yield_force) == others[1]
    assert "the fastest excitation (the paper's 10 mm at 8 Hz is not" in found.viscosity.rule
    assert "nearest to a quarter" in found.yield_force.rule
    assert {r.current for r in found.stiffness.readings} == {0.4}
    asked = straight_line_fits(loops, slow=others[2], high_currents=(0.2,))
    assert excitation_of(loops, asked.yield_force) == others[2]
    assert {r.current for r in asked.stiffness.readings} == {0.2}
    absent = straight_line_fits(loops, fast=FAST)
    assert absent.undetermined[0] == (
        "C_post is not determined: no test has 10 mm at 8 Hz, as asked"
    )


def test_what_a_campaign_lacks_is_said():
    loops = sweep_loops(excitations=(FAST,))
    alone = straight_line_fits(loops)
    assert alone.undetermined == (
        "F_y is not determined: no test is slower than half the peak velocity of 10 mm at 8 Hz, "
        "as F_y needs",
    )
    assert alone.stiffness_line is not None
    cold = replace(loops, temperature=np.full(len(loops.ids), np.nan))
    unknown = straight_line_fits(cold)
    assert len(unknown.viscosity.readings) == 15
    assert unknown.viscosity_lines == ()
    assert "no current has 3 tests at known and different temperatures" in unknown.undetermined[0]
    with pytest.raises(FitError, match="no test has a known current"):
        straight_line_fits(replace(loops, current=np.full(len(loops.ids), np.nan)))


def test_tests_of_unknown_current_are_no_part_of_it():
    loops = sweep_loops()
    current = loops.current.copy()
    current[0] = np.nan
    found = straight_line_fits(replace(loops, current=current))
    assert [r.test for r in found.viscosity.readings] == list(range(1, 15))


def test_a_bias_is_divided_out(loops, found):
    truth = np.array([laws(i, t) for i, t in zip(loops.current, loops.temperature, strict=True)]).T
    bias = recipe_bias(found, *truth)
    assert max(map(abs, bias.viscosity.values())) < 0.05
    plain = straight_line_fits(loops, bias=bias)
    for stage, which in ((plain.viscosity, 0), (plain.yield_force, 1)):
        for r in stage.readings:
            assert r.value == pytest.approx(truth[which][r.test], rel=1e-12)
    few = straight_line_fits(loops, bias=Bias({"test0": 0.1}, {}, {}))
    assert [r.id for r in few.viscosity.readings] == ["test0"]
    assert few.yield_force.left_out["test15"] == "the recipe's bias is not known for it"


def test_a_recipe_that_bends_is_no_law_that_bends(loops, found):
    """Truth is straight; the recipe reads up to 4 % too much in the middle of the sweep."""
    laws_of = {r.id: 0.04 * (1.0 - ((r.temperature - 45.0) / 30.0) ** 2)
               for r in found.viscosity.readings}  # fmt: skip
    bias = Bias(laws_of, {}, {})
    bent = replace(
        found.viscosity,
        readings=tuple(
            replace(r, value=r.value * (1.0 + laws_of[r.id])) for r in found.viscosity.readings
        ),
    )
    read = lines_without(replace(found, viscosity=bent), Bias(dict.fromkeys(laws_of, 0.0), {}, {}))
    plain = lines_without(read, bias)
    said = "C_post against temperature: the lines together bend"
    assert said in " ".join(sentences(read))
    judged = " ".join(sentences(read, plain))
    assert "C_post against temperature, the recipe's bias divided out: no curvature" in judged
    bending, straight = shown(line_table(read)), shown(line_table(read, plain))
    assert "is better" in bending
    assert straight.count("is better") < bending.count("is better")
    assert "without the recipes' bias" in straight


def test_model_loops_have_the_motion_and_one_quiet_cycle(loops):
    quiet = with_force(loops, 2.0 * loops.force)
    np.testing.assert_array_equal(quiet.velocity, loops.velocity)
    np.testing.assert_array_equal(quiet.force, 2.0 * loops.force)
    assert set(quiet.cycles) == {1}
    assert quiet.deviations[0].shape == (1, loops.force.shape[1])


def test_sentences_tell_tests_points_and_doubts(found):
    told = " ".join(sentences(found))
    assert "C_post from 10 mm at 8 Hz, the paper's, points at 10 to 90 %" in told
    assert "F_y against temperature: no curvature shown" in told
    assert "Lines of k at 0.8, 1 A are not told apart" in told
    assert "error of temperature of" in told


def shown(table) -> str:
    console = Console(width=220)
    with console.capture() as capture:
        console.print(table)
    return capture.get()


def test_tables(loops, found):
    lines = shown(line_table(found))
    assert "pooled" in lines
    assert "15, 75" in lines
    assert "offset / N" in lines
    change = found.stiffness_line.line.change(15.0, 75.0)
    assert f"{change.percent:+.1f} % ({change.low:+.1f} … {change.high:+.1f})" in lines
    bias = Bias({r.id: 0.05 for r in found.viscosity.readings}, {}, {})
    table = shown(bias_table(found, bias))
    assert table.count("C_post") == 3
    assert "+5.0 %" in table


def test_the_command_line_shows_lines_sentences_and_bias(found, capsys):
    bias = Bias({}, {r.id: -0.01 for r in found.yield_force.readings}, {})
    show_straight_lines(Talk(), found, bias)
    told = capsys.readouterr().out
    assert told.index("Straight-line identification") < told.index("k scatters by")
    assert told.index("k scatters by") < told.index("Bias of the recipes")


def test_figures_draw_the_points_used_and_the_lines(loops, found):
    ax = plot_points_used((loops, found.viscosity))
    cold, warm = found.viscosity.readings[10], found.viscosity.readings[14]
    assert (cold.current, cold.temperature, warm.temperature) == (1.0, 15.0, 75.0)
    dots = [line for line in ax.lines if line.get_marker() == "."]
    for reading, drawn in zip((cold, warm), dots, strict=True):
        np.testing.assert_array_equal(drawn.get_xdata(), loops.velocity[reading.test, reading.used])
        np.testing.assert_array_equal(drawn.get_ydata(), loops.force[reading.test, reading.used])
    against = plot_against_temperature((found.stiffness, found.stiffness_lines))
    line = found.stiffness_lines[0].line
    t = np.asarray(against.lines[0].get_xdata())
    np.testing.assert_allclose(against.lines[0].get_ydata(), line.at(t)[0])
    assert straight_lines_png(loops, found, "a sweep").startswith(b"\x89PNG")


def test_measured_loops_of_a_damper_are_read(utfsm_folder, utfsm_manifest):
    """Other excitations, gas force, seating; temperature was not recorded."""
    campaign = load_campaign(utfsm_folder, utfsm_manifest)
    found = straight_line_fits(cut_loops(campaign.records).loops)
    for stage in (found.viscosity, found.yield_force):
        assert [r.current for r in stage.readings] == [0.0, 0.25, 0.5, 0.75, 1.0]
        value = np.array([r.value for r in stage.readings])
        assert (np.diff(value) > 3.0 * max(r.se for r in stage.readings)).all()
    (stiff,) = found.stiffness.readings
    assert 3e6 < stiff.value < 3e7
    assert stiff.spread > 0.1 * stiff.value  # its unloading bends
    assert found.stiffness_line is None
    assert len(found.undetermined) == 3
