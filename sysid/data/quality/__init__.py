"""What is wrong with a campaign's tests, with evidence: `inspect`."""

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Final

from sysid.data.cycles import cut_loops
from sysid.data.quality.clipping import check_clipping
from sysid.data.quality.coverage import check_coverage, check_several_tests
from sysid.data.quality.drift import (
    check_displacement_drift,
    check_force_drift,
    check_temperature_drift,
)
from sysid.data.quality.dropout import check_dropout
from sysid.data.quality.duplicates import check_duplicates
from sysid.data.quality.fault import KINDS, Fault
from sysid.data.quality.frozen import check_frozen
from sysid.data.quality.hum import check_hum
from sysid.data.quality.labels import check_labels
from sysid.data.quality.negative_current import check_negative_current
from sysid.data.quality.one_sign import check_one_sign
from sysid.data.quality.plausible import check_plausible
from sysid.data.quality.report import QualityReport, TestQuality
from sysid.data.quality.resolution import check_quantisation
from sysid.data.quality.sampling import check_aliasing, check_time
from sysid.data.quality.scale import check_scale
from sysid.data.quality.sign import NO_DAMPER, check_sign
from sysid.data.quality.subject import Subject, subjects
from sysid.data.quality.velocity import check_velocity
from sysid.data.quality.waveform import check_waveform
from sysid.data.record import OWN_GRID

if TYPE_CHECKING:
    from sysid.data.campaign import Campaign

__all__ = ["CHECKS", "KINDS", "Fault", "QualityReport", "Subject", "TestQuality", "inspect"]

CHECKS: Final[tuple[Callable[[Subject], list[Fault]], ...]] = (
    check_coverage,
    check_several_tests,
    check_sign,
    check_one_sign,
    check_clipping,
    check_dropout,
    check_frozen,
    check_displacement_drift,
    check_force_drift,
    check_temperature_drift,
    check_labels,
    check_velocity,
    check_aliasing,
    check_time,
    check_quantisation,
    check_hum,
    check_waveform,
    check_plausible,
)
"""Checks of one test; `check_duplicates`, `check_negative_current` and `check_scale` compare tests,
and stand beside them."""

_ORDER = {"fatal": 0, "warning": 1, "note": 2}


def inspect(campaign: "Campaign", points: int = 360) -> QualityReport:
    """Check every test of a campaign; nothing is changed or left out by it.

    Args:
        campaign: As read.
        points: Phase points of a loop.
    """
    cut = cut_loops(campaign.records, points)
    seen = subjects(campaign.records, cut)
    twins, negative = check_duplicates(seen), check_negative_current(seen)
    faults = [
        twins.get(s.record.id, [])
        + negative.get(s.record.id, [])
        + [fault for check in CHECKS for fault in check(s)]
        for s in seen
    ]
    sound = [s for s, own in zip(seen, faults, strict=True) if not any(f.fatal for f in own)]
    odd = check_scale(sound)
    tests = tuple(
        _summarised(s, own + odd.get(s.record.id, [])) for s, own in zip(seen, faults, strict=True)
    )
    return QualityReport(campaign.name, tests, cut, _why_not(tests))


def _summarised(subject: Subject, faults: list[Fault]) -> TestQuality:
    record, steady, loop = subject.record, subject.steady, subject.loop
    return TestQuality(
        id=record.id,
        nominal=record.nominal,
        amplitude=None if steady is None else steady.amplitude,
        frequency=None if steady is None else steady.frequency,
        centre=None if steady is None else steady.centre,
        current=record.nominal.current if loop is None else _known(loop.current),
        temperature=record.nominal.temperature if loop is None else _known(loop.temperature),
        cycles=0 if steady is None else steady.cycles,
        noise_floor=None if loop is None else _known(loop.noise_floor),
        peak_force=subject.peak_force,
        left_out=subject.left_out,
        faults=tuple(sorted(faults, key=lambda fault: _ORDER[fault.severity])),
        remarks=() if steady is None else steady.left_out,
        changes=record.source.changes,
    )


def _shows_damper(test: TestQuality) -> bool:
    """A sound loop, or a sound record of another motion."""
    return not test.fatal and (test.left_out is None or test.kind in OWN_GRID)


def _known(value: float) -> float | None:
    return None if math.isnan(value) else float(value)


def _wrong_signs(wrong: Sequence[str], tests: Sequence[TestQuality]) -> str:
    """What to do about tests in which the force opposes the velocity: all of them, or some."""
    some = any(_shows_damper(test) for test in tests)
    cure = (
        "correct the sign in these files, or leave them out with --exclude (the manifest and "
        "--flip-force turn every test)"
        if some
        else "state the signs in the manifest, or use --flip-force"
    )
    return (
        f"in {len(wrong)} of {len(tests)} tests the force opposes the velocity "
        f"({', '.join(wrong[:3])}{', …' if len(wrong) > 3 else ''}): {cure}"
    )


def _why_not(tests: tuple[TestQuality, ...]) -> tuple[str, ...]:
    """Why a fit of these tests would be meaningless."""
    reasons = []
    wrong = [t.id for t in tests if any(f.kind == "wrong_sign" for f in t.faults)]
    if 2 * len(wrong) >= sum(t.kind not in NO_DAMPER for t in tests) > 0:
        reasons.append(_wrong_signs(wrong, tests))
    sines = [test for test in tests if test.kind == "sine"]
    spoilt = [test for test in sines if test.fatal]
    if sines and 2 * len(spoilt) > len(sines) and len(spoilt) > len(wrong):
        reasons.append(f"{len(spoilt)} of {len(sines)} tests have a fatal fault")
    if not any(_shows_damper(test) for test in tests):
        reasons.append("no test gives a sound loop")
    return tuple(reasons)
