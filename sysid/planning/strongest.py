"""The largest force that proposed tests would ask of rig and load cell."""

from collections.abc import Sequence

import numpy as np

from sysid.diagnosis.questions import Question
from sysid.planning.advice import AT_ONCE, Advice
from sysid.planning.candidates import Candidate, batches
from sysid.planning.discrimination import predict


def strongest(
    tests: Sequence[Advice], questions: Sequence[Question], temperature: float
) -> dict[Candidate, float]:
    """Largest |force| over the cycle under any explanation of the questions asked, N, per test.

    Args:
        tests: That are proposed.
        questions: All that are open; of each test those count that it is about.
        temperature: °C at which to test; NaN if unknown.
    """
    found: dict[Candidate, float] = {}
    for question in questions:
        own = [a.test for a in tests if a.about == question.about]
        for batch in batches(own, AT_ONCE):
            seen = [predict(one, batch, temperature) for one in question.alternatives]
            most = np.max([np.abs(s.force).max(axis=1) for s in seen], axis=0)
            for test, force in zip(batch, most.tolist(), strict=True):
                found[test] = max(force, found.get(test, 0.0))
    return found
