"""What kind of force is left: parity of the residual, and how it grows."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops
from sysid.diagnosis.exponents import Exponent
from sysid.diagnosis.lack_of_fit import LackOfFit, lack_of_fit
from sysid.diagnosis.parity import PARITIES
from sysid.report.page.wording import UNKNOWN, interval, number, share

MEANING: Final[Mapping[str, str]] = {
    "OD": "friction, viscous and yield forces",
    "OC": "springs, masses, delay of the force",
    "ED": "friction that depends on the position",
    "EC": "offsets, asymmetric gain, gas",
}
"""Parity → what such a force usually is."""

RARE: Final = 0.01
"""Probability by chance below which a residual is more than noise, shared by all tests."""


@dataclass(frozen=True)
class Kind:
    """One parity of what a model leaves.

    Attributes:
        parity: Its letters.
        meaning: What such a force usually is.
        share: Of the residual's energy.
        share_text: Likewise, as text.
        exponents: How its RMS grows with amplitude, frequency and current.
    """

    parity: str
    meaning: str
    share: float
    share_text: str
    exponents: tuple[str, ...]


@dataclass(frozen=True)
class Left:
    """What one model leaves.

    Attributes:
        model: Its name.
        kinds: All four.
        sentence: In how many tests it is more than noise.
        rms: RMS of the residual over all tests, N.
    """

    model: str
    kinds: tuple[Kind, ...]
    sentence: str
    rms: str


def what_is_left(
    loops: Loops, models: Mapping[str, Float[np.ndarray, "loop phase"]]
) -> tuple[Left, ...]:
    """Look at the residual of every model; tests of unknown force are passed over.

    Args:
        loops: L tests.
        models: Name → [L, J] N, simulated.
    """
    found = []
    for name, force in models.items():
        sound = np.asarray(np.isfinite(force).all(axis=1))
        if sound.any() and force.shape[1] % 2 == 0:
            found.append(_left(name, lack_of_fit(loops.select(sound), force[sound])))
    return tuple(found)


def _left(name: str, found: LackOfFit) -> Left:
    kinds = tuple(
        Kind(
            p, MEANING[p], found.parity[p], share(found.parity[p]),
            tuple(_exponent(e) for e in found.exponents[p]),
        )
        for p in PARITIES
    )  # fmt: skip
    known = found.probability[np.isfinite(found.probability)]
    if known.size:
        more = int(np.sum(known < RARE / known.size))
        sentence = (
            f"In {more} of {known.size} tests with two cycles or more it is larger than the "
            "scatter between cycles explains."
        )
    else:
        sentence = "No test has two cycles, so that nothing tells what repeats."
    rms = float(np.sqrt(np.mean(found.residual**2)))
    return Left(name, kinds, sentence, f"{number(rms)} N")


def _exponent(e: Exponent) -> str:
    if not np.isfinite(e.value):
        return UNKNOWN
    return f"{round(e.value, 1) + 0.0:.1f} ({interval(e.low, e.high)})".replace("-", "−")
