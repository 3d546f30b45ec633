"""Which tests are held out together, in matrices and in sweeps over temperature."""

from dataclasses import replace

import numpy as np

from sysid.data.loops import Loops
from sysid.diagnosis.evidence import FEWEST_CONDITIONS, held_together
from tests.data.loop_of import loops_of

SWEEP = [(a, f, t, i) for a, f in ((10e-3, 8.0), (5e-3, 4.0)) for t in (15, 30, 45, 60, 75)
         for i in (0.0, 0.5, 1.0)]  # fmt: skip


def sweep(rows) -> Loops:
    amplitude, frequency, temperature, current = np.array(rows).T
    loops = loops_of(np.zeros((amplitude.size, 72)), amplitude, frequency, current)
    return replace(loops, temperature=temperature)


def test_a_matrix_is_held_out_by_amplitude_and_frequency():
    rows = [(a, f, 40 + 10 * i, i) for a in (2e-3, 5e-3) for f in (1.0, 4.0) for i in (0.0, 1.0)]
    found = held_together(sweep(rows))
    assert np.array_equal(found, [0, 0, 1, 1, 2, 2, 3, 3])


def test_a_sweep_of_two_excitations_is_cut_by_temperature_and_keeps_its_currents_together():
    loops = sweep(SWEEP)
    found = held_together(loops)
    assert len(np.unique(found)) == 2 * FEWEST_CONDITIONS
    keys = {(n, a) for n, a in zip(found, loops.amplitude, strict=True)}
    assert len(keys) == 2 * FEWEST_CONDITIONS, "no part holds two excitations"
    for warm in (15, 75):
        first = found[(loops.temperature == warm) & (loops.amplitude == 5e-3)]
        assert first.size == 3
        assert np.ptp(first) == 0
    shuffle = np.random.default_rng(0).permutation(len(loops.ids))
    again = held_together(loops.select(shuffle))
    same = found[shuffle][:, None] == found[shuffle]
    assert np.array_equal(again[:, None] == again, same)


def test_temperatures_that_are_not_known_or_do_not_vary_cut_nothing():
    loops = sweep(SWEEP)
    for warm in (np.full(len(SWEEP), np.nan), 40.0 + 0.01 * np.arange(len(SWEEP))):
        assert set(held_together(replace(loops, temperature=warm))) == {0, 1}
