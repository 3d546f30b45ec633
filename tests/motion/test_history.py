"""Place in the campaign and the way the current came."""

from dataclasses import replace

import numpy as np

from sysid.data.record import Conditions, Record
from sysid.motion.history import history_of, into_cycle, run_history, with_history
from sysid.motion.motion import sine_motion
from sysid.rig.trial_campaign import make_trial
from tests.data.loop_of import loops_of

NO_LOOPS = loops_of(np.zeros((0, 8)), np.zeros(0), np.zeros(0), np.zeros(0))


def test_ramp_is_the_last_change_of_current_in_the_order_of_the_tests():
    order = np.array([3.0, 1.0, 2.0, 5.0, 4.0])
    current = np.array([0.4, 0.0, 0.4, 0.1, 0.4])
    motion = with_history(
        sine_motion(0.01, np.ones(5), current, points=8), run_history(order, current)
    )
    assert motion.ramp is not None
    assert motion.run_share is not None
    assert motion.cycle is None
    assert np.asarray(motion.ramp)[:, 0].tolist() == [1.0, 0.0, 1.0, -1.0, 1.0]
    assert np.asarray(motion.run_share)[:, 0].tolist() == [0.5, 0.0, 0.25, 1.0, 0.75]


def test_scatter_of_a_recorded_current_is_no_change_of_it():
    order = np.arange(6)
    meant = np.array([0.0, 0.4, 0.4, 0.4, 0.2, 0.2])
    exact = run_history(order, meant)
    recorded = run_history(order, meant + 2e-4 * np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0]))
    assert exact.ramp.tolist() == recorded.ramp.tolist() == [0.0, 1.0, 1.0, 1.0, -1.0, -1.0]


def test_steps_below_the_scatter_add_up_to_a_change():
    assert run_history(np.arange(9), 0.4 + 0.003 * np.arange(9)).ramp[-1] == 1.0


def test_an_unknown_current_changes_nothing():
    current = np.array([0.1, 0.3, np.nan, 0.3, 0.2])
    assert run_history(np.arange(5), current).ramp.tolist() == [0.0, 1.0, 1.0, 1.0, -1.0]


def test_a_part_of_a_campaign_keeps_its_places_among_all():
    current = (0.0, 0.4, 0.4, 0.1)
    records = [_record(f"t{k}", k + 1, i) for k, i in enumerate(current)]
    whole = run_history(np.arange(4), np.array(current))
    for ids in (("t3",), ("t2", "t1"), ("t0", "t1", "t2", "t3")):
        some = history_of(ids, records, NO_LOOPS)
        assert some is not None
        places = [int(name[1]) for name in ids]
        np.testing.assert_array_equal(some.share, whole.share[places])
        np.testing.assert_array_equal(some.ramp, whole.ramp[places])


def test_a_test_without_a_place_has_no_history_and_does_not_take_that_of_others():
    records = [_record("t0", 1, 0.0), _record("tare", None, 0.0), _record("t1", 2, 0.4)]
    assert history_of(("t0", "tare"), records, NO_LOOPS) is None
    known = history_of(("t1",), records, NO_LOOPS)
    assert known is not None
    assert (known.share.tolist(), known.ramp.tolist()) == ([1.0], [1.0])


def test_rest_with_the_supply_off_is_no_change_of_current():
    """A record has rest in it, of any length; the current of a test is that of its steady part."""
    meant = np.array([0.0, 1.0, 1.0, 1.0, 1.0])
    records = []
    for k, (current, rest) in enumerate(zip(meant, (5, 3, 10, 2, 12), strict=True)):
        time = np.arange(50.0 + rest)
        channel = np.where(time < rest, 0.0, current)
        record = _record(f"t{k}", k + 1, None)
        records.append(replace(record, time=time, current=channel))
    loops = loops_of(np.zeros((5, 8)), np.full(5, 0.01), np.ones(5), meant)
    loops = replace(loops, ids=tuple(r.id for r in records))
    for some in (loops, NO_LOOPS):
        found = history_of(loops.ids, records, some)
        assert found is not None
        assert found.ramp.tolist() == [0.0, 1.0, 1.0, 1.0, 1.0]


def _record(name: str, order: int | None, current: float | None) -> Record:
    time = np.arange(4.0)
    return Record(
        name, time, np.sin(time), np.cos(time), nominal=Conditions(current=current, run_order=order)
    )


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
