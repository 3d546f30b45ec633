"""Which faults keep a test out of fits and comparisons: the one place where that is decided.

- A fatal fault does: the test does not show the damper.
- A drop-out does, unless it is a mere note: the force channel was gone for a while, and no weight
  or repeatability makes up for it.
- So does a sine test without a steady loop, such as one whose current changes.
- Everything else does not: the fit bears it; `sysid check` shows it, and commands that use such a
  test say so (`borne_told`).
"""

from collections.abc import Mapping, Sequence

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


def borne(report: QualityReport) -> dict[str, tuple[Fault, ...]]:
    """Warnings of tests that are used all the same, by test; tests without any are not in it."""
    found = {
        test.id: tuple(f for f in test.faults if f.severity == "warning" and not spoils(f))
        for test in report.tests
    }
    return {name: faults for name, faults in found.items() if faults}


def borne_told(warnings: Mapping[str, tuple[Fault, ...]], used: Sequence[str]) -> tuple[str, ...]:
    """One sentence a kind of fault.

    Args:
        warnings: As from `borne`.
        used: Ids of the tests that are used.
    """
    kinds: dict[str, list[tuple[str, str]]] = {}
    for name in used:
        for fault in warnings.get(name, ()):
            kinds.setdefault(fault.kind, []).append((name, fault.evidence))
    return tuple(
        f"{kind} in {len(found)} of {len(used)} tests that are used, such as {found[0][0]}: "
        f"{found[0][1]} (`sysid check` lists all)"
        if len(found) > 1
        else f"{kind} in {found[0][0]}, which is used: {found[0][1]}"
        for kind, found in kinds.items()
    )


def spoils(fault: Fault) -> bool:
    """Whether a fault keeps a test out."""
    return fault.fatal or (fault.kind == "dropout" and fault.severity != "note")
