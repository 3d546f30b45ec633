"""Drop-outs of any length and depth that matter are found; noise and wandering jumps are not."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.data.record import Record
from tests.data.quality.planted import clean, cycle_of, faults_of
from tests.data.synthetic import knee_force, make_record


def lose(record: Record, at: tuple[float, ...], length: float, depth: float) -> Record:
    force = record.force.copy()
    for cycle in at:
        begin = int(np.searchsorted(cycle_of(record), cycle))
        force[begin : begin + max(1, round(length * 500))] *= 1.0 - depth
    return replace(record, force=force)


@pytest.mark.parametrize("length", [0.002, 0.01, 0.05])
@pytest.mark.parametrize("depth", [0.15, 0.5, 1.0])
def test_lost_force_inside_the_stroke_is_found(length: float, depth: float) -> None:
    (fault,) = faults_of(lose(clean(), (4.0, 7.5), length, depth))["dropout"]
    assert "briefly 2 times" in fault.evidence


def test_force_that_jumps_up_is_found_too() -> None:
    (fault,) = faults_of(lose(clean(), (5.02,), 0.01, -0.2))["dropout"]
    assert "briefly 1 times" in fault.evidence


def test_what_does_not_matter_is_not_flagged() -> None:
    assert "dropout" not in faults_of(lose(clean(), (4.0, 7.5), 0.01, 0.03))


def test_what_happens_in_every_cycle_is_the_loop() -> None:
    every = tuple(np.arange(0.0, 15.0) + 0.01)
    assert "dropout" not in faults_of(lose(clean(), every, 0.02, 0.3))


@pytest.mark.parametrize("seed", range(20))
def test_heavy_tailed_noise_is_no_dropout(seed: int) -> None:
    record = make_record(cycles=9.3)
    rng = np.random.default_rng(seed)
    noisy = replace(record, force=record.force + 20.0 * rng.standard_t(8, record.time.size))
    assert "dropout" not in faults_of(noisy)


@pytest.mark.parametrize("cycles", [12.26, 12.3, 12.5])
@pytest.mark.parametrize("per_cycle", [39.2, 500.0])
def test_a_jump_that_wanders_is_no_dropout(per_cycle: float, cycles: float) -> None:
    """The knee comes up to 3 % of a cycle early or late, in each cycle anew, the last one, too."""
    time = np.arange(0.0, cycles, 1.0 / per_cycle)
    phase = 2.0 * np.pi * time
    rng = np.random.default_rng(4)
    shift = 2.0 * np.pi * rng.uniform(-0.03, 0.03, 14)[np.round(time).astype(int)]
    force = knee_force(phase + shift, 50.0) + rng.normal(0.0, 5.0, time.size)
    record = Record("wander", time, 0.01 * np.sin(phase), force)
    assert "dropout" not in faults_of(record)


@pytest.mark.parametrize("seed", range(5))
def test_one_step_of_a_coarse_converter_is_no_dropout(seed: int) -> None:
    """12 N steps, 3 N of noise, a force of 130 N: single steps are 9 % of its peak."""
    record = make_record(cycles=9.3, seed=seed)
    rng = np.random.default_rng(seed)
    force = 0.11 * record.force + rng.normal(0.0, 3.0, record.time.size)
    assert "dropout" not in faults_of(replace(record, force=12.0 * np.round(force / 12.0)))
    lost = lose(replace(record, force=force), (4.0,), 0.01, 1.0)
    assert "dropout" in faults_of(replace(lost, force=12.0 * np.round(lost.force / 12.0)))


def test_a_channel_that_stays_within_a_plateau_is_not_frozen() -> None:
    """Steps as coarse as the knee is high: one value for nearly half a cycle, twice a cycle."""
    record = make_record(cycles=9.3)
    flat = replace(record, force=500.0 * np.sign(record.force))
    assert "dropout" not in faults_of(flat)
