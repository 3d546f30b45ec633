"""Place in the campaign and the way the current came."""

from dataclasses import replace

import numpy as np

from sysid.motion.history import into_cycle, with_history
from sysid.motion.motion import sine_motion
from sysid.rig.trial_campaign import make_trial


def test_ramp_is_the_last_change_of_current_in_the_order_of_the_tests():
    order = np.array([3.0, 1.0, 2.0, 5.0, 4.0])
    current = np.array([0.4, 0.0, 0.4, 0.1, 0.4])
    motion = with_history(sine_motion(0.01, np.ones(5), current, points=8), run_order=order)
    assert motion.ramp is not None
    assert motion.run_share is not None
    assert motion.cycle is None
    assert np.asarray(motion.ramp)[:, 0].tolist() == [1.0, 0.0, 1.0, -1.0, 1.0]
    assert np.asarray(motion.run_share)[:, 0].tolist() == [0.5, 0.0, 0.25, 1.0, 0.75]


def test_without_an_order_nothing_is_claimed():
    motion = with_history(sine_motion(0.01, np.ones(2), 0.1, points=8), cycle=np.array([0.0, 3.0]))
    assert motion.run_share is None
    assert motion.ramp is None
    assert np.asarray(motion.cycle)[:, 0].tolist() == [0.0, 3.0]


def test_time_into_the_cycle_runs_from_where_it_begins():
    loops = make_trial(5).loops.select(np.array([0, 1]))
    loops = replace(loops, start_phase=np.array([0.0, np.pi]))
    into = into_cycle(loops, 4)
    np.testing.assert_allclose(into, [[-0.5, -0.25, 0.0, 0.25], [0.0, 0.25, -0.5, -0.25]])
    np.testing.assert_array_equal(into_cycle(replace(loops, start_phase=None), 4), np.zeros((2, 1)))
