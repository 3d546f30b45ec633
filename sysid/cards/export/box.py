"""What an exported program knows of the conditions that its card was identified in.

A step has one sample: it tells a displacement, a velocity, a current and a temperature beyond those
of the tests (`instants`), by the same ends as `sysid simulate`.
"""

import math

from sysid.cards.export.pieces import NEEDS, Pieces
from sysid.cards.outside import instants
from sysid.cards.schema import Card, Pair
from sysid.effects.reference_temperature import REFERENCE


def conditions(card: Card) -> str:
    """All conditions of the card's tests, in words."""
    box = card.validity
    told = [f"amplitudes {_span(box.amplitude, 1e3)} mm"]
    if box.frequency is not None:
        told.append(f"frequencies {_span(box.frequency)} Hz")
    told += [f"speeds up to {box.velocity[1]:.4g} m/s", f"currents {_span(box.current)} A"]
    if box.temperature is not None:
        told.append(f"{_span(box.temperature)} degC")
    return ", ".join(told)


def ranges(card: Card) -> dict[str, str]:
    """What each input of a sample was in the card's tests: name → words, SI and degC."""
    box = card.validity
    warm = "none known" if box.temperature is None else f"{_span(box.temperature)} degC"
    return {
        "displacement": f"up to {box.amplitude[1]:.4g} m from the centre",
        "velocity": f"up to {box.velocity[1]:.4g} m/s",
        "current": f"{_span(box.current)} A",
        "temperature": warm,
    }


def not_told(card: Card) -> str:
    """What no single sample tells, in words: frequency, and a stroke that is too small."""
    box = card.validity
    frequency = "" if box.frequency is None else f" ({_span(box.frequency)} Hz)"
    return f"the frequency{frequency}, and amplitudes below {box.amplitude[0]:.4g} m"


def unknown_temperature(card: Card, pieces: Pieces) -> float:
    """°C that stands for one that is not known, in formats without NAN.

    It is 40 °C.  Where the force does not go by temperature, any number does: it is the one of the
    card's tests that is nearest to 40 °C, so that nothing is told that nobody has said.
    """
    box = card.validity.temperature
    if box is None or goes_by_temperature(pieces):
        return REFERENCE
    return min(max(REFERENCE, box[0]), box[1])


def goes_by_temperature(pieces: Pieces) -> bool:
    """Whether the force of a damper depends on temperature."""
    return any(piece.kind in NEEDS["warmth"] for piece in pieces.all)


def ends(card: Card, pieces: Pieces) -> dict[str, float]:
    """Marks of `c/validity.c.in`: the ends of what counts as inside, SI and °C.

    An unknown temperature is the 40 °C that it is computed with, NaN where nothing goes by it.
    """
    box = instants(card.validity)
    cold, warm = box.temperature or (-math.inf, math.inf)
    return {
        "REACH": box.reach,
        "SPEED": box.speed,
        "LEAST": box.current[0],
        "MOST": box.current[1],
        "COLD": cold,
        "WARM": warm,
        "UNKNOWN": REFERENCE if goes_by_temperature(pieces) else math.nan,
    }


def _span(pair: Pair, factor: float = 1.0) -> str:
    return f"{factor * pair[0]:.4g} to {factor * pair[1]:.4g}"
