"""Whether a test moved at all, for how many steady cycles, and whether it is one test."""

from sysid.data.other_motions import CURE
from sysid.data.quality.fault import Fault
from sysid.data.quality.subject import Subject

FEW = 3
"""Cycles below which repeatability rests on one difference or on none."""


def check_several_tests(subject: Subject) -> list[Fault]:
    """Steady motion beside the part that the loop is of, or several of which none prevails."""
    if subject.reason == "several_motions":
        return [Fault("several_tests", "fatal", subject.left_out or "several motions")]
    told = () if subject.steady is None else subject.steady.others
    return [
        Fault("several_tests", "warning", f"{text}; if that is another test, {CURE}")
        for text in told
    ]


def check_coverage(subject: Subject) -> list[Fault]:
    """Rest only, less than one whole steady cycle, or too few to see repeatability."""
    if subject.reason == "rest_only":
        return [Fault("rest_only", "fatal", subject.left_out or "no motion")]
    if subject.reason in ("too_few_cycles", "not_sinusoidal"):
        return [Fault("too_few_cycles", "fatal", subject.left_out or "no whole cycle")]
    if subject.steady is None or subject.steady.cycles >= FEW:
        return []
    cycles = subject.steady.cycles
    if cycles == 1:
        text = "one whole steady cycle: repeatability is not known"
        return [Fault("too_few_cycles", "warning", text)]
    text = f"{cycles} whole steady cycles: repeatability is roughly known"
    return [Fault("too_few_cycles", "note", text)]
