"""Which faults keep a test out of fits and comparisons: the one place where that is decided.

- A fatal fault does: the test does not show the damper.
- A drop-out does, unless it is a mere note: the force channel was gone for a while, and no weight
  or noise floor makes up for it.
- So does a sine test without a steady loop, such as one whose current changes.
- Everything else does not: the fit bears it, and `sysid check` shows it.
"""

from sysid.data.quality import Fault, QualityReport, TestQuality


def unfit(report: QualityReport) -> dict[str, str]:
    """Tests that are left out → the reason, one sentence."""
    reasons = {}
    for test in report.tests:
        spoiling = [fault for fault in test.faults if spoils(fault)]
        if spoiling:
            reasons[test.id] = f"{spoiling[0].kind}: {spoiling[0].evidence}"
        elif (reason := not_a_loop(test)) is not None:
            reasons[test.id] = reason
    return reasons


def not_a_loop(test: TestQuality) -> str | None:
    """Why a sine test without a fault that spoils it gives no loop; None if it gives one."""
    spoilt = any(spoils(fault) for fault in test.faults)
    return None if spoilt or test.kind != "sine" else test.left_out


def spoils(fault: Fault) -> bool:
    """Whether a fault keeps a test out."""
    return fault.fatal or (fault.kind == "dropout" and fault.severity != "note")
