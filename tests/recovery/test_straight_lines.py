"""The recipes on loops of the lumped model: biases as they were read, and lines without them."""

import numpy as np
import pytest
from lumped_campaign import CURRENTS, clean_loops, noisy_loops, sweep, table_1
from straight_lines import DENSE, FIGURE_5, OTHERS, biases, line_of, percents, true_change

from sysid.identification.recipes_beside import recipes_beside
from sysid.identification.straight_lines.bias import Bias
from sysid.identification.straight_lines.model_loops import recipe_bias
from sysid.identification.straight_lines.recipes import straight_line_fits
from sysid.identification.straight_lines.windows import Windows

STRONG = (0.4, 0.6, 0.8, 1.0)


@pytest.fixture(scope="module")
def bias() -> Bias:
    return biases(DENSE)


def ends(of: dict[str, float], *currents: float) -> tuple[int, int]:
    """Smallest and largest bias in whole per cent."""
    z = percents(of, *currents)
    return round(z.min()), round(z.max())


def test_viscosity_is_3_to_8_per_cent_too_high(bias):
    """At 0.2 A, where C_post is least, more: up to 9."""
    assert ends(bias.viscosity, 0.0, *STRONG) == (3, 8)
    assert ends(bias.viscosity, 0.2) == (5, 9)


def test_yield_force_is_too_low_by_up_to_1_2_per_cent_and_14_without_current(bias):
    z = percents(bias.yield_force, *STRONG)
    assert z.max() == pytest.approx(-0.3, abs=0.05)
    # −1.251, read as −1.2; 720 points a cycle give −1.249
    assert z.min() == pytest.approx(-1.2, abs=0.052)
    idle = percents(bias.yield_force, 0.0)
    np.testing.assert_allclose(idle, -14.5, atol=0.6)
    np.testing.assert_allclose(percents(bias.yield_force, 0.2), -2.4, atol=0.4)


def test_stiffness_is_wrong_by_minus_1_to_plus_8_per_cent(bias):
    assert ends(bias.stiffness, *CURRENTS) == (-1, 8)
    assert ends(bias.stiffness, 0.8, 1.0) == (5, 8)


@pytest.mark.parametrize(("window", "percent"), OTHERS)
def test_other_windows_move_viscosity_of_the_warm_idle_damper(window, percent):
    found = 100.0 * biases(DENSE, window).viscosity["10mm_8Hz_0A_75C"]
    assert found == pytest.approx(percent, abs=0.05)


def test_changes_of_figure_5_come_back_once_the_bias_is_taken_out():
    """Noise 1 %, 2 N, 0.3 K: 95 % intervals of six sweeps; at most 4 of 24 may miss by chance."""
    tests = sweep((0.8, 1.0, 2.0), tuple(np.linspace(11.0, 75.0, 9)))
    clean, truth = clean_loops(tests)
    known = recipe_bias(straight_line_fits(clean), *truth)
    windows = Windows(post_grid=(), yield_grid=())
    exact = np.array([true_change(z) for z in FIGURE_5])
    np.testing.assert_allclose(exact, [z.percent for z in FIGURE_5], atol=0.5)
    hits = {None: np.zeros(4), "known": np.zeros(4)}
    for seed in range(6):
        loops, _ = noisy_loops(tests, np.random.default_rng((7, seed)))
        for which, bias in ((None, None), ("known", known)):
            found = straight_line_fits(loops, bias=bias, windows=windows)
            changes = [line_of(found, z).change(z.cold, z.hot) for z in FIGURE_5]
            hits[which] += [c.low <= true <= c.high for c, true in zip(changes, exact, strict=True)]
            narrow = [c.high - c.low < 0.15 * abs(c.percent) for c in changes]
            assert all(narrow) or bias is None
    assert hits["known"].sum() >= 20
    assert hits[None][0] <= 1


def test_at_one_temperature_there_is_no_line_and_it_says_why():
    tests = sweep((0.0, 1.0), (15.0,))
    beside = recipes_beside(table_1(), clean_loops(tests)[0])
    assert not beside.any_line
    assert "different temperatures" in beside.found.undetermined[0]
