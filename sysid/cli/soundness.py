"""Which faults keep a test out of fits and comparisons: the one place where that is decided.

- A fatal fault does: the test does not show the damper.
- A drop-out does, unless it is a mere note: the force channel was gone for a while, and no weight
  or noise floor makes up for it.
- Everything else does not: the fit bears it, and `sysid check` shows it.
"""

from sysid.data.quality import Fault, QualityReport


def unfit(report: QualityReport) -> dict[str, str]:
    """Tests that are left out → the reason, one sentence."""
    reasons = {}
    for test in report.tests:
        spoiling = [fault for fault in test.faults if spoils(fault)]
        if spoiling:
            reasons[test.id] = f"{spoiling[0].kind}: {spoiling[0].evidence}"
    return reasons


def spoils(fault: Fault) -> bool:
    """Whether a fault keeps a test out."""
    return fault.fatal or (fault.kind == "dropout" and fault.severity != "note")
