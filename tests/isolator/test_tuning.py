"""Ziegler and Nichols' gains, and the search for feedback linearisation."""

import equinox as eqx
import pytest

from sysid.isolator.base_motion import butterworth_motion
from sysid.isolator.closed_loop import Clock
from sysid.isolator.lumped_step import lumped_step
from sysid.isolator.plant import mass_isolator
from sysid.isolator.tuning import Ultimate, per_ampere, search_feedback, ultimate


def test_the_rule():
    """BS09's gains are those of K_u = 8.3e-4 A/N and T_u = 5 ms."""
    gain, integral, derivative = Ultimate(8.333e-4, 5e-3).pid
    assert gain == pytest.approx(5e-4, rel=1e-3)
    assert integral == pytest.approx(0.2, rel=1e-3)
    assert derivative == pytest.approx(3.13e-7, rel=5e-3)


def test_a_slower_current_oscillates_later_and_longer(valve, number):
    step = lumped_step(valve, number(15))
    found = ultimate(step, step)
    assert 1e-4 < found.gain < 2e-2
    assert 2e-3 < found.period < 0.05
    slow = eqx.tree_at(lambda d: d.tau, lumped_step(valve, number(15)), number(0.012))
    later = ultimate(slow, slow)
    assert later.gain > found.gain  # the lag filters more than it turns
    assert later.period > found.period


def test_the_search_finds_the_least_of_its_grid(valve, number):
    base, clock = butterworth_motion([1], duration=0.5), Clock(1e-3, 4)
    step = lumped_step(valve, number(15))
    slope = per_ampere(step)
    found = search_feedback(mass_isolator(), step, slope, base, 2000.0, clock)
    feedback, gain = found.best
    at = list(zip(found.feedbacks, found.feedforwards, strict=True)).index((feedback, gain))
    assert found.judged[at] == found.judged.min() < 2.0
