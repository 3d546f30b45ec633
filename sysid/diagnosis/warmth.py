"""Whether the temperatures of a campaign can show what depends on them."""

import numpy as np
from jaxtyping import Float

from sysid.models.levels import SPAN


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
        told = f"{low}" if low == high else f"{low} to {high}"
        return f"all tests are at one temperature ({told} °C)"
    return None
