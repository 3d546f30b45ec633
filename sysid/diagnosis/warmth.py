"""Whether the temperatures of a campaign can show what depends on them."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops
from sysid.models.levels import SPAN
from sysid.motion.history import RunHistory

LIKE_DRIFT: Final = ("viscosity_temperature", "yield_temperature")
"""Effects that a drift over the campaign stays one of where the temperature may go with it."""
APART_FROM_DRIFT: Final = (
    "Record the temperature of every test, and repeat the first one at its temperature at the end"
)
"""What tells a drift from such an effect."""
STEADY: Final = 1.0
"""K; temperatures that differ by less change no force by what a drift does."""
GOES_WITH: Final = 0.5
"""Correlation of temperature and order from which the one may pass for the other."""
FEWEST: Final = 6
"""Known temperatures below which a correlation says nothing."""
SHOWN: Final = 3
"""Ids of tests that are named."""


def warmth_untold(temperature: Float[np.ndarray, " loop"]) -> str | None:
    """Which tests do not know their temperature; None where all do.

    Args:
        temperature: [L] °C of each test; NaN where it is not known.
    """
    unknown = np.isnan(temperature)
    if unknown.all():
        return "no temperature was recorded"
    if unknown.any():
        return f"the temperature of {unknown.sum()} of {unknown.size} tests is not known"
    return None


def warmth_unseen(temperature: Float[np.ndarray, " loop"]) -> str | None:
    """Why no effect of temperature can be seen in these tests; None where it could be.

    A test whose temperature is not known would count as one at the reference, and where all tests
    have one temperature an effect of it is what an effect without it is: a preload, say.

    Args:
        temperature: [L] °C of each test; NaN where it is not known.
    """
    untold = warmth_untold(temperature)
    if untold is not None:
        return untold
    if np.ptp(temperature) < SPAN:
        low, high = round(float(temperature.min())), round(float(temperature.max()))
        if low == high:
            return f"all tests are at one temperature ({low} °C)"
        return f"temperatures differ by less than {SPAN:g} K ({low} to {high} °C)"
    return None


def tell_temperatures(temperature: Float[np.ndarray, " loop"], ids: Sequence[str]) -> str | None:
    """What to do about tests whose temperature alone is not known; None where there are none.

    Args:
        temperature: [L] °C of each test; NaN where it is not known.
        ids: Of the tests.
    """
    unknown = [id for id, t in zip(ids, temperature, strict=True) if np.isnan(t)]
    if not 0 < len(unknown) < len(ids):
        return None
    some = ", ".join(unknown[:SHOWN]) + (" …" if len(unknown) > SHOWN else "")
    return f"Tell the temperature of {some} in tests.csv, or leave them out with --exclude"


def drifts_like_warmth(loops: Loops, history: RunHistory | None) -> bool:
    """What a campaign lost from its first to its last test may be what it warmed or cooled by.

    So it is where effects of temperature cannot be seen and nothing says that the temperature did
    not go with the order of the tests.

    Args:
        loops: L tests.
        history: Of these, if their order is known.
    """
    if history is None:
        return False
    temperature = loops.temperature
    known = np.isfinite(temperature)
    if known.all() and np.ptp(temperature) >= SPAN:
        return False
    if known.sum() < FEWEST or np.ptp(history.share[known]) == 0.0:
        return True
    if np.ptp(temperature[known]) < STEADY:
        return not known.all()
    return abs(float(np.corrcoef(temperature[known], history.share[known])[0, 1])) > GOES_WITH
