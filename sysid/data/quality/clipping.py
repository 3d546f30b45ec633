"""A channel that stops at a limit: flat tops."""

import numpy as np
from jaxtyping import Float

from sysid.data.figures import figure
from sysid.data.quality.fault import Fault
from sysid.data.quality.resolution import resolution
from sysid.data.quality.subject import Subject
from sysid.data.steady import longest_true

SPIKE = 4.0
"""Samples at the extreme over those one level below: 2.4 at the crest of a sinusoid."""
LONGEST = 3
FEWEST = 10
MOSTLY = 0.5


def check_clipping(subject: Subject) -> list[Fault]:
    """Samples that stand exactly at a channel's extreme, far more than just below it.

    A smooth crest has 1/(√2 − 1) = 2.4 times as many samples in its last level as in the one
    below; a clipped one has a spike there.  Levels are the resolution of the channel, or 0.2 % of
    its range where that is finer.
    """
    record, faults = subject.record, []
    for name, unit, values in (
        ("force", "N", subject.steady_part(record.force)),
        ("displacement", "m", subject.steady_part(record.displacement)),
    ):
        if name == "displacement" and subject.steady is None:
            continue
        values = values[np.isfinite(values)]
        for side, signed in (("largest", values), ("smallest", -values)):
            share = clipped_share(signed)
            if share > 0.0:
                limit = float(signed.max()) * (1.0 if side == "largest" else -1.0)
                text = (
                    f"{name} stays at its {side} value, {figure(limit, 6)} {unit}, "
                    f"for {100 * share:.1f} % of the samples"
                )
                severity = "fatal" if share > MOSTLY else "warning"
                faults.append(Fault("clipping", severity, text))
    return faults


def clipped_share(values: Float[np.ndarray, " n"]) -> float:
    """Share of samples at the maximum if it is a spike of the histogram, else 0."""
    span = float(np.ptp(values)) if values.size else 0.0
    if span == 0.0:
        return 0.0
    step = resolution(values)
    top = values >= values.max() - max(0.5 * step, 1e-6 * span)
    level = max(1.5 * step, 2e-3 * span)
    below = (values >= values.max() - level) & ~top
    count = int(top.sum())
    first, last = longest_true(top)
    if count < FEWEST or last - first < LONGEST or count < SPIKE * int(below.sum()):
        return 0.0
    return count / values.size
