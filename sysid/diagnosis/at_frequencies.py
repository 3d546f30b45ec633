"""A law of frequency in the terms of who fits each frequency by itself."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from sysid.data.loops import Loops
from sysid.diagnosis.result import Cause
from sysid.diagnosis.tied import FREE, OF_FREQUENCY
from sysid.diagnosis.words import EFFECT_WORDS

_WHOLE: Final = "the yield force and the viscosity"
_PARTS: Final = {"yield": "the yield force", "viscous": "the viscosity"}


def frequencies_told(cause: Cause, loops: Loops) -> Iterator[str]:
    """By how much parameters found at the one end are wrong at the other; nothing otherwise.

    Of a class or a family that is only said for the case that the law is the cause.

    Args:
        cause: With a law of frequency as its first member.
        loops: The tests.
    """
    low, high = float(loops.frequency.min()), float(loops.frequency.max())
    if cause.members[0] not in OF_FREQUENCY or np.log(high / low) < FREE:
        return
    size = cause.parameters[0]

    def more(change: float) -> float:
        """What is found at the high frequency over what is found at the low one, less one."""
        return (1.0 + change * np.log10(high)) / (1.0 + change * np.log10(low)) - 1.0

    middle, ends = more(size.value), (more(size.low), more(size.high))
    what = _PARTS.get(getattr(cause.effect, "part", ""), _WHOLE)
    fits, they, are = ("fit", "they", "are") if what == _WHOLE else ("fits", "it", "is")
    side = "above" if middle > 0.0 else "below"
    by = f"{100.0 * abs(middle):.2g} ± {50.0 * abs(ends[1] - ends[0]):.1g} %"
    if_so = "So" if cause.status == "named" else f"If it is {EFFECT_WORDS[cause.members[0]]},"
    yield (
        f"{if_so} {what} that {fits} {high:.3g} Hz {are} {by} {side} what fits {low:.3g} Hz: "
        f"found at the one, {they} {are} wrong at the other."
    )
