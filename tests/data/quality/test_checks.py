"""Each fault planted and found; the clean test free of it."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from sysid.data.quality import KINDS
from sysid.data.record import Record
from tests.data.quality.planted import (
    a_day,
    clean,
    clipped,
    coarse,
    coarsely_sampled,
    dropping,
    fading,
    faults_of,
    flickering,
    flipped,
    followed_by,
    frozen,
    gappy,
    growing,
    hardly_begun,
    humming,
    in_another_unit,
    in_milliseconds,
    jittered,
    labelled,
    paused,
    recorded,
    rectified,
    repaired,
    resting,
    shortened,
    sinking,
    slowly_sampled,
    squashed,
    stroke_stop,
    unplugged,
    wandering,
    warming,
    with_velocity,
)

PLANTED = {
    "mm for m": (in_another_unit(1e3), "implausible", "warning", "an amplitude of 10 m at 2 Hz"),
    "m for mm": (in_another_unit(1e-3), "rest_only", "fatal", "stays within 0.02 mm"),
    "s for ms": (in_milliseconds, "implausible", "warning", "a cycle of 500 s is slower than"),
    "N for kN": (in_another_unit(1.0, 1e6), "implausible", "warning", "MN is beyond any damper"),
    "a long stroke in m for mm": (
        in_another_unit(3e-3),
        "implausible",
        "warning",
        "of 0.03 mm shows the",
    ),
    "mA for A": (labelled(current=500.0), "implausible", "warning", "a current of 500 A is"),
    "mA for A, recorded": (
        recorded(current=500.0),
        "implausible",
        "warning",
        "a current of 500 A is beyond",
    ),
    "K for °C": (labelled(temperature=293.15), "implausible", "warning", "of 293.1 °C is beyond"),
    "K for °C, recorded": (
        recorded(temperature=293.15),
        "implausible",
        "warning",
        "K or °F taken for °C",
    ),
    "°C for K": (recorded(temperature=-253.0), "implausible", "warning", "°C taken for K"),
    "a negative current": (
        labelled(current=-0.5),
        "negative_current",
        "fatal",
        "-0.5 A is below zero; the force of a damper does not depend on its sign",
    ),
    "a negative current, recorded": (
        recorded(current=-0.5),
        "negative_current",
        "fatal",
        "write it positive",
    ),
    "last bit": (flickering, "no_force", "fatal", "does not follow the motion"),
    "no force": (unplugged(0.0), "no_force", "fatal", "37 N at every sample"),
    "only noise": (unplugged(4.0), "no_force", "fatal", "does not follow the motion"),
    "only the mains": (unplugged(1.0, 20.0), "no_force", "fatal", "a mean of 37 N"),
    "force clipped": (clipped, "clipping", "warning", "largest value, 900 N"),
    "stroke stopped": (stroke_stop, "clipping", "warning", "smallest value, -0.0395 m"),
    "amplitude grows": (growing, "amplitude_drift", "warning", "amplitude changes between"),
    "centre wanders": (wandering, "centre_drift", "warning", "centre moves by"),
    "force fades": (fading, "force_drift", "warning", "force changes in size"),
    "force sinks": (sinking, "force_drift", "warning", "mean force moves by"),
    "gets warm": (warming, "temperature_drift", "warning", "°C"),
    "drops out": (dropping, "dropout", "warning", "briefly 3 times in"),
    "freezes": (frozen(8.2, 99.0), "dropout", "fatal", "for 5 cycles of the motion"),
    "freezes for a while": (frozen(6.0, 6.9), "dropout", "fatal", "for 0.9 cycles of the motion"),
    "a magnitude": (rectified, "one_sign", "fatal", "the same way in both strokes"),
    "wrong sign": (flipped, "wrong_sign", "fatal", "opposes the velocity"),
    "3 % faster": (labelled(frequency=1.94), "frequency_mislabelled", "note", "+3.1 %"),
    "twice as fast": (
        labelled(frequency=1.0),
        "frequency_mislabelled",
        "warning",
        "twice the label",
    ),
    "7 % smaller": (labelled(amplitude=0.0108), "amplitude_mislabelled", "note", "-7.4 %"),
    "no stroke": (labelled(amplitude=0.0), "amplitude_mislabelled", "warning", "label says 0 mm"),
    "peak to peak": (
        labelled(amplitude=0.02),
        "amplitude_mislabelled",
        "warning",
        "half the label",
    ),
    "1000 times": (labelled(amplitude=1e-5), "amplitude_mislabelled", "fatal", "1000 times the"),
    "a millisecond for a second": (
        labelled(frequency=2000.0),
        "frequency_mislabelled",
        "fatal",
        "1/1000 of the label",
    ),
    "an inch for a millimetre": (
        labelled(amplitude=0.254),
        "amplitude_mislabelled",
        "fatal",
        "another unit",
    ),
    "velocity in between": (with_velocity(1.04, 0.0), "velocity_scale", "note", "1.040 times"),
    "velocity negative": (with_velocity(-1.0, 0.0), "velocity_scale", "warning", "opposite"),
    "velocity late": (with_velocity(1.0, 0.01), "velocity_delay", "warning", "10 ms late"),
    "steps of 40 N": (coarse, "quantisation", "note", "steps of 40 N"),
    "jitter": (jittered, "time_irregular", "note", "scatters by"),
    "gap": (gappy, "time_irregular", "warning", "1 gaps"),
    "pause": (paused, "time_irregular", "warning", "between gaps, the rest is left out"),
    "repaired stamps": (repaired, "time_irregular", "note", "repeat in 3"),
    "rest": (resting, "rest_only", "fatal", "no motion"),
    "8.3 a cycle": (coarsely_sampled, "aliasing", "warning", "8.3 samples a cycle: knees and"),
    "28 a cycle": (slowly_sampled, "aliasing", "warning", "quarter of the sampling rate"),
    "cannot be": (labelled(frequency=1200.0), "aliasing", "fatal", "cannot be sampled"),
    "hum": (humming(5.0), "mains_hum", "note", "at 49.8 Hz"),
    "loud hum": (humming(50.0, 60.2), "mains_hum", "warning", "at 60.2 Hz"),
    "no pure sine": (squashed, "waveform_distortion", "note", "most of it the 3rd with 3.0 %"),
    "one cycle": (shortened, "too_few_cycles", "warning", "one whole"),
    "another test behind": (
        followed_by(8.0, 3.0),
        "several_tests",
        "warning",
        "cycles of 10 mm at 3 Hz after the steady part",
    ),
    "many tests": (a_day, "several_tests", "fatal", "several steady motions follow each other"),
    "not one cycle": (hardly_begun, "too_few_cycles", "fatal", "cycle"),
}


@pytest.mark.parametrize("name", PLANTED)
def test_planted_fault_is_found_with_evidence(name: str) -> None:
    plant, kind, severity, evidence = PLANTED[name]
    found = faults_of(plant(clean())).get(kind, [])
    assert [fault.severity for fault in found] == [severity], found
    assert evidence in found[0].evidence


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("rate", [80.4, 1000.0, 4000.0])
def test_a_clean_test_has_no_fault(seed: int, rate: float) -> None:
    kinds = faults_of(clean(seed=seed, rate=rate))
    assert set(kinds) <= ({"aliasing"} if rate < 100 else set())


def test_what_rigs_do_is_plausible() -> None:
    sound = (
        labelled(current=49.0, temperature=-59.0),
        labelled(current=5.0, temperature=199.0),
        in_another_unit(6e-3),
        recorded(500.0, current=0.5, temperature=20.0),
    )
    for change in sound:
        assert "implausible" not in faults_of(change(clean()))


def test_a_motion_that_is_no_sine_is_held_against_the_same_units() -> None:
    change = labelled(current=500.0)
    record = change(replace(clean(), nominal=replace(clean().nominal, kind="random")))
    assert [f.kind for f in faults_of(record)["implausible"]] == ["implausible"]


def test_every_kind_has_a_planted_case() -> None:
    assert {kind for _, kind, _, _ in PLANTED.values()} == set(KINDS) - {"duplicate", "force_scale"}


@pytest.mark.parametrize("seed", range(20))
def test_noise_without_a_sensor_has_no_sign(seed: int) -> None:
    record = clean(cycles=3.3)
    noise = np.random.default_rng(seed).normal(size=record.time.size)
    kinds = faults_of(replace(record, force=noise))
    assert "wrong_sign" not in kinds
    assert "no_force" in kinds


@pytest.mark.parametrize("rebound", [0.0, 0.1, 10.0])
def test_strokes_that_differ_by_any_factor_are_a_damper(rebound: float) -> None:
    record = clean()
    force = np.where(record.force > 0.0, record.force, rebound * record.force)
    assert "one_sign" not in faults_of(replace(record, force=force))


@pytest.mark.parametrize("seed", range(20))
def test_a_damper_far_below_its_noise_is_heard(seed: int) -> None:
    """Noise leaves little of itself in the first harmonics of a median cycle."""
    record = clean(noise=0.0)
    noise = np.random.default_rng(seed).normal(size=record.time.size)
    faint = replace(record, force=0.4 * record.force / np.std(record.force) + noise)
    assert not {"no_force", "one_sign"} & set(faults_of(faint))


@pytest.mark.parametrize("cycles", [2.3, 3.3, 12.3])
@pytest.mark.parametrize("spikes", [1, 2, 3])
def test_spikes_do_not_silence_a_damper(cycles: float, spikes: int) -> None:
    record = clean(cycles=cycles)
    force = record.force.copy()
    force[np.linspace(1000, force.size - 1200, spikes).astype(int)] = 1e6
    assert not {"no_force", "one_sign"} & set(faults_of(replace(record, force=force)))


def test_a_rig_without_a_damper_may_be_silent() -> None:
    record = unplugged(1.0)(clean())
    for kind in ("rod_disconnected", "tare"):
        assert not faults_of(replace(record, nominal=replace(record.nominal, kind=kind)))


def test_velocity_that_agrees_is_no_fault() -> None:
    assert not faults_of(with_velocity(1.0, 0.0)(clean()))


def test_mostly_clipped_is_fatal() -> None:
    record = clean(ramp=0.0, rest=0.0)
    limited = replace(record, force=np.clip(record.force, -300.0, 300.0))
    severities = [fault.severity for fault in faults_of(limited)["clipping"]]
    assert len(severities) == 2
    heavy = replace(record, force=np.clip(record.force, -2000.0, -300.0))
    assert "fatal" in [fault.severity for fault in faults_of(heavy)["clipping"]]


@pytest.mark.parametrize("frequency", [2.0, 2.3])
@pytest.mark.parametrize("cycles", [5.3, 40.3])
def test_hum_has_its_size_however_much_the_mean_cycle_took(frequency: float, cycles: float) -> None:
    record = clean(frequency=frequency, cycles=cycles)
    (fault,) = faults_of(humming(12.0, 50.17)(record))["mains_hum"]
    assert float(fault.evidence.split("with ")[1].split()[0]) == pytest.approx(12.0, rel=0.1)


def test_hum_at_a_multiple_of_the_tests_frequency_is_the_damper_s_for_all_we_know() -> None:
    assert "mains_hum" not in faults_of(humming(12.0, 50.0)(clean()))


@pytest.mark.parametrize("change", [fading, sinking, growing, dropping, coarse])
def test_cycles_that_differ_do_not_hum(change: Callable[[Record], Record]) -> None:
    """Whatever happens from cycle to cycle happens beside every multiple of the frequency."""
    for frequency in (1.03, 2.0, 4.7):
        assert "mains_hum" not in faults_of(change(clean(frequency=frequency)))


def test_noise_does_not_hum() -> None:
    rng = np.random.default_rng(8)
    for _ in range(40):
        record = clean(frequency=float(rng.uniform(0.5, 8.0)), noise=30.0,
                       seed=int(rng.integers(2**31)))  # fmt: skip
        assert "mains_hum" not in faults_of(record)
