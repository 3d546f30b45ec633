"""What a check finds: kind, severity, evidence."""

from dataclasses import dataclass
from typing import Final, Literal, get_args

Kind = Literal[
    "clipping",
    "dropout",
    "amplitude_drift",
    "centre_drift",
    "force_drift",
    "temperature_drift",
    "no_force",
    "force_scale",
    "wrong_sign",
    "one_sign",
    "frequency_mislabelled",
    "amplitude_mislabelled",
    "velocity_scale",
    "velocity_delay",
    "aliasing",
    "too_few_cycles",
    "several_tests",
    "quantisation",
    "time_irregular",
    "duplicate",
    "rest_only",
    "mains_hum",
    "waveform_distortion",
    "implausible",
    "negative_current",
]
Severity = Literal["note", "warning", "fatal"]

KINDS: Final[tuple[str, ...]] = get_args(Kind)


@dataclass(frozen=True)
class Fault:
    """One fault of one test.

    Attributes:
        kind: What it is.
        severity: ``note`` (known, harmless to a fit), ``warning`` (the fit bears it),
            ``fatal`` (a fit on this test is meaningless).
        evidence: One sentence with numbers.
    """

    kind: Kind
    severity: Severity
    evidence: str

    @property
    def fatal(self) -> bool:
        """Whether a fit on the test is meaningless."""
        return self.severity == "fatal"


def graded(kind: Kind, size: float, note: float, warning: float, evidence: str) -> list[Fault]:
    """A note from one size on, a warning from a larger one on, nothing below."""
    if not size >= note:
        return []
    return [Fault(kind, "warning" if size >= warning else "note", evidence)]
