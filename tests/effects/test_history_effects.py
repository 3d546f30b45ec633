"""Effects of the campaign's order are nothing where the order is not known."""

import numpy as np
import pytest

from sysid.effects.registry import effect_kind, make
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.motion.history import run_history, with_history
from sysid.motion.motion import sine_motion
from sysid.parameters import build

VALVE = build(Generalized, LOW_SYMMETRIC)
LOOPS = sine_motion(0.0125, np.full(3, 1.5), np.array([0.0, 0.4, 0.2]), points=24)
KNOWN = with_history(
    LOOPS,
    run_history(np.arange(3), np.asarray(LOOPS.current)[:, 0]),
    cycle=np.array([0.0, 1.0, 50.0]),
)


@pytest.mark.parametrize(
    "id", ["run_drift", "magnetic_hysteresis", "first_cycle_breakaway", "self_heating"]
)
def test_nothing_without_history(id):
    damper = Damper(VALVE, (make(effect_kind(id)),))
    assert np.allclose(damper.force(LOOPS), VALVE.force(LOOPS), rtol=0.0, atol=1e-9)
    assert not np.allclose(damper.force(KNOWN), VALVE.force(LOOPS), atol=1.0)


def test_a_raised_current_makes_less_force_and_a_lowered_one_more():
    damper = Damper(VALVE, (make(effect_kind("magnetic_hysteresis")),))
    change = np.abs(damper.force(KNOWN)).max(axis=1) - np.abs(VALVE.force(LOOPS)).max(axis=1)
    assert change[0] == 0.0
    assert change[1] < 0.0
    assert change[2] > 0.0


def test_drift_and_first_cycles_end_where_they_should():
    drift = Damper(VALVE, (make(effect_kind("run_drift")),)).force(KNOWN)
    ratio = np.abs(drift).max(axis=1) / np.abs(VALVE.force(LOOPS)).max(axis=1)
    np.testing.assert_allclose(ratio, [1.0, 0.985, 0.97], rtol=1e-9)
    fresh = Damper(VALVE, (make(effect_kind("first_cycle_breakaway")),)).force(KNOWN)
    extra = np.abs(fresh - VALVE.force(LOOPS)).max(axis=1)
    np.testing.assert_allclose(extra, 50.0 * np.exp([0.0, -0.5, -25.0]), rtol=1e-6, atol=1e-9)
