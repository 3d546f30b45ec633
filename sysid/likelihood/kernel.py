"""K_c: how alike errors of a valve's laws are at two tests.

Half of the variance is that of a squared exponential in ln A, ln f, i and, for a valve that has
laws of temperature, T; half that of one several times as smooth.  A valve without such laws is
wrong at 60 °C as it is at 20 °C; of one with a straight line for each of its forces nobody expects
that.
"""

from typing import Final, TypeAlias

import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops
from sysid.effects.reference_temperature import REFERENCE
from sysid.models.coordinates import reference_current

Lengths: TypeAlias = tuple[float, float, float, float]
"""Correlation lengths of the laws' errors in ln A, ln f, i/i_max and temperature, K."""
LENGTHS: Final[Lengths] = (1.2, 1.2, 0.5, np.inf)
"""Shortest ones of a valve whose force does not go by temperature; those of a campaign are found
by `smoothness`."""
WARM: Final = 30.0
"""K, the shortest of a valve that has laws of temperature."""
LONGER: Final = 3.0
"""Half of the variance is that of errors so many times smoother: a trend over the whole range must
not be taken for an effect."""


def shortest(*, thermal: bool) -> Lengths:
    """Shortest correlation lengths that errors of a valve's laws are taken to have.

    Args:
        thermal: The valve has laws of temperature.
    """
    return (*LENGTHS[:3], WARM) if thermal else LENGTHS


def kernel_of(loops: Loops, lengths: Lengths = LENGTHS) -> Float[np.ndarray, "loop loop"]:
    """K_c between the tests of a campaign, [L, L].

    Args:
        loops: L tests.
        lengths: Correlation lengths.
    """
    place = places_of(
        loops.amplitude, loops.frequency, loops.current, loops.temperature,
        reference_current(loops.current),
    )  # fmt: skip
    return kernel_between(place, place, lengths)


def kernel_between(
    places: Float[np.ndarray, "loop 4"], others: Float[np.ndarray, "other 4"], lengths: Lengths
) -> Float[np.ndarray, "loop other"]:
    """K_c between `places_of` tests."""
    apart = np.sum(((places[:, None, :] - others[None, :, :]) / np.array(lengths)) ** 2, axis=2)
    return 0.5 * (np.exp(-0.5 * apart) + np.exp(-0.5 * apart / LONGER**2))


def places_of(
    amplitude: Float[np.ndarray, " loop"],
    frequency: Float[np.ndarray, " loop"],
    current: Float[np.ndarray, " loop"],
    temperature: Float[np.ndarray, " loop"],
    largest: float,
) -> Float[np.ndarray, "loop 4"]:
    """(ln A, ln f, i/i_max, T) of tests.

    Args:
        amplitude: [L] m.
        frequency: [L] Hz.
        current: [L] A.
        temperature: [L] °C; NaN, where it is not known, counts as what models take for it.
        largest: i_max, A.
    """
    known = np.where(np.isfinite(temperature), temperature, REFERENCE)
    return np.stack([np.log(amplitude), np.log(frequency), current / largest, known], axis=1)
