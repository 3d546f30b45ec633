"""Springs with friction behind them are solved, and the measure of that sees where they are not."""

import jax
import numpy as np
import pytest
from outcome import Outcome
from unsolved_springs import SOLVED, row

from sysid.effects import series_spring


def unsolved(friction: str, dampers: int = 4) -> tuple[int, float]:
    """Loops left open, and the worst of them in parts of max|F|."""
    page = Outcome("unsolved_springs", "")
    row("a fifth as steep", friction, dampers, page)
    (numbers,) = page.numbers.values()
    return numbers["unsolved"], numbers["worst"]


@pytest.mark.parametrize("friction", ["none", "presliding"])
def test_friction_that_does_not_fall_with_speed_leaves_nothing_open(friction):
    assert unsolved(friction) == (0, pytest.approx(0.0, abs=0.01 * SOLVED))


def test_a_coarse_table_alone_leaves_loops_open_and_is_told(monkeypatch):
    monkeypatch.setattr(series_spring, "ROUNDS", 1)
    monkeypatch.setattr(series_spring, "MOST_STEPS", 0)
    jax.clear_caches()
    loops, worst = unsolved("none")
    jax.clear_caches()
    assert loops > 100
    assert 100.0 * SOLVED < worst < np.inf
