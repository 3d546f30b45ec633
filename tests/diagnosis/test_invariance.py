"""The same damper in other units, another order, another sign convention: the same answer."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sysid.data.campaign import load_campaign
from sysid.data.cycles import cut_loops
from sysid.data.loops import Loops
from sysid.diagnosis.prototypes import exponents_of
from sysid.diagnosis.result import Diagnosis, Quantity
from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import make_trial
from tests.diagnosis.diagnosed import DESIGN, diagnosed


def scaled(loops: Loops, force: float = 1.0, length: float = 1.0, current: float = 1.0) -> Loops:
    """Every number multiplied as another unit would; time stays."""
    return replace(
        loops,
        displacement=length * loops.displacement,
        velocity=length * loops.velocity,
        acceleration=length * loops.acceleration,
        amplitude=length * loops.amplitude,
        centre=length * loops.centre,
        harmonics=length * loops.harmonics,
        displacement_deviations=tuple(length * d for d in loops.displacement_deviations),
        force=force * loops.force,
        deviations=tuple(force * d for d in loops.deviations),
        noise_floor=force * loops.noise_floor,
        current=current * loops.current,
    )


def shuffled(loops: Loops) -> Loops:
    """Other order, other names."""
    order = np.random.default_rng(5).permutation(len(loops.ids))
    return replace(loops.select(order), ids=tuple(f"test {k:03d}" for k in range(order.size)))


def mirrored(loops: Loops) -> Loops:
    """Extension positive instead of compression: x and F negated, phase counted from −x."""
    half = loops.force.shape[1] // 2

    def other(z: np.ndarray) -> np.ndarray:
        return -np.roll(z, -half, axis=-1)

    order = np.arange(1, loops.harmonics.shape[1] + 1)
    return replace(
        loops,
        displacement=other(loops.displacement),
        velocity=other(loops.velocity),
        acceleration=other(loops.acceleration),
        force=other(loops.force),
        deviations=tuple(other(d) for d in loops.deviations),
        displacement_deviations=tuple(other(d) for d in loops.displacement_deviations),
        centre=-loops.centre,
        harmonics=-((-1.0) ** order) * loops.harmonics,
        start_phase=None if loops.start_phase is None else loops.start_phase + np.pi,
    )


def finer(loops: Loops, points: int = 500) -> Loops:
    """The same loops on more phase points than their 360, by Fourier interpolation."""

    def more(z: np.ndarray) -> np.ndarray:
        now = z.shape[-1]
        lines = np.fft.rfft(z, axis=-1)
        lines[..., -1] *= 0.5
        return np.fft.irfft(lines, points, axis=-1) * (points / now)

    return replace(
        loops,
        displacement=more(loops.displacement),
        velocity=more(loops.velocity),
        acceleration=more(loops.acceleration),
        force=more(loops.force),
        deviations=tuple(more(d) for d in loops.deviations),
        displacement_deviations=tuple(more(d) for d in loops.displacement_deviations),
    )


def doubled(loops: Loops) -> Loops:
    """Every cycle recorded twice."""
    twice = tuple(np.concatenate([d, d]) for d in loops.deviations)
    floor = [np.sqrt(np.mean(np.var(d, axis=0, ddof=1))) for d in twice]
    paths = tuple(np.concatenate([d, d]) for d in loops.displacement_deviations)
    return replace(
        loops,
        cycles=2 * loops.cycles,
        deviations=twice,
        displacement_deviations=paths,
        noise_floor=np.array(floor),
    )


Change = Callable[[Loops], Loops]
CHANGES: dict[str, tuple[Change, float, float]] = {
    "other units, shuffled": (lambda z: shuffled(scaled(z, 30.0, 0.2, 1e3)), 30.0, 0.2),
    "opposite signs": (mirrored, 1.0, 1.0),
    "500 points": (finer, 1.0, 1.0),
    "cycles duplicated": (doubled, 1.0, 1.0),
}
"""Name → change, and by how much it multiplies newtons and metres.

Force × 30, stroke × 0.2, current × 1000, another order and other names are one change: what depends
on any of them depends on all at once, since no two of these factors make up for one another.
"""


def said(d: Diagnosis) -> tuple:
    """The answer without numbers."""
    causes = tuple((c.status, c.id, c.members) for c in d.causes)
    return d.answer, causes, {z.id for z in d.invisible}, d.unknown.present


def factor(q: Quantity, force: float, length: float) -> float:
    newton, metre = exponents_of(q.unit)
    return force**newton * length**metre


@pytest.mark.slow
@pytest.mark.parametrize("name", CHANGES)
def test_answer_and_size_are_those_of_the_same_damper(name, spring_trial, spring):
    change, force, length = CHANGES[name]
    other = diagnosed(change(spring_trial.loops))
    assert said(other) == said(spring)
    for here, there in zip(other.causes, spring.causes, strict=True):
        assert here.confidence == pytest.approx(there.confidence, abs=0.01)
        for a, b in zip(here.parameters, there.parameters, strict=True):
            unit = factor(a, force, length)
            assert a.value / unit == pytest.approx(b.value, abs=0.05 * b.sd)
            assert a.sd / unit == pytest.approx(b.sd, rel=0.05)
    assert other.gain is not None
    assert spring.gain is not None
    assert other.gain.before == pytest.approx(spring.gain.before, rel=0.01)
    assert other.gain.after == pytest.approx(spring.gain.after, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["other units, shuffled", "opposite signs"])
def test_silence_is_kept(name, plain):
    other = diagnosed(CHANGES[name][0](plain.loops))
    assert said(other) == said(plain)
    assert plain.answer == "nothing"


@pytest.mark.slow
def test_the_other_sign_convention_turns_what_has_a_sign():
    """A preload pushes the other way; its size is the same."""
    loops = make_trial(71, (find_planter("gas_preload"),), (1.0,), DESIGN).loops
    here, there = diagnosed(loops), diagnosed(mirrored(loops))
    assert said(here) == said(there)
    (one,), (other,) = here.causes[0].parameters, there.causes[0].parameters
    assert here.causes[0].id == "force_offset"
    assert other.value == pytest.approx(-one.value, abs=0.05 * one.sd)
    assert other.low == pytest.approx(-one.high, abs=0.1 * one.sd)


def written(loops: Loops, folder: Path, start: float, skip: int) -> Path:
    """The tests as files: from `start` s on, without the first `skip` samples."""
    folder.mkdir()
    points = loops.force.shape[1]
    for k, name in enumerate(loops.ids):
        cycles = int(loops.cycles[k])
        t = start + np.arange(cycles * points) / (points * loops.frequency[k])
        x = 1e3 * np.tile(loops.displacement[k], cycles)
        f = (loops.force[k] + loops.deviations[k]).ravel()
        rows = np.column_stack([t, x, f])[skip:]
        lines = [f"{a:.9g},{b:.9g},{c:.9g}" for a, b, c in rows]
        (folder / f"{name}.csv").write_text("\n".join(["time_s,displacement_mm,force_N", *lines]))
    return folder


@pytest.mark.slow
def test_another_origin_of_time_through_files(tmp_path, spring_trial, spring):
    """Clocks that start elsewhere, records that begin elsewhere in the cycle."""
    read = []
    for start, skip in ((0.0, 0), (1234.5, 25)):
        folder = written(spring_trial.loops, tmp_path / f"from {start:g}", start, skip)
        read.append(cut_loops(load_campaign(folder).records).loops)
    assert read[0].ids == read[1].ids
    assert not np.allclose(read[0].force, read[1].force, rtol=1e-4), "other cycles are averaged"
    for loops in read:
        found = diagnosed(loops)
        assert said(found)[:2] == said(spring)[:2]
        (one,), (other,) = found.causes[0].parameters, spring.causes[0].parameters
        assert one.value == pytest.approx(other.value, abs=1.5 * other.sd)
