"""A yield force without current that rises with temperature: no fluid's, so another's."""

import re
from typing import Final

import numpy as np
from scipy.stats import norm

from sysid.data.loops import Loops
from sysid.diagnosis.ladder import CAP, UNSURE
from sysid.diagnosis.quantities import LEVEL, NORMAL, Values
from sysid.diagnosis.result import Cause, Quantity
from sysid.diagnosis.words import amount
from sysid.effects.reference_temperature import REFERENCE
from sysid.effects.registry import effect_kind, make

MEMBERS: Final = ("seal_friction", "residual_magnetism")
"""What holds a damper without current, beside its fluid."""
_SLOPE: Final = re.compile(r"F_y\[(.+) A\]\.slope")
_INTERCEPT, _SLOPE_AT_0 = "F_y[0 A].intercept", "F_y[0 A].slope"
_TEST: Final = (
    "Degauss the coil with a decaying alternating current and repeat 0 A at the coldest and the "
    "warmest temperature: what the steel kept is gone then, friction of the seals is not"
)


def idle_yield(values: Values, loops: Loops) -> Cause | None:
    """The class of causes that a table of yield forces over temperature points to.

    The yield stress of a fluid in a field falls as it warms.  If the yield force falls at every
    current but rises at 0 A, what yields there is not the fluid.  The base model's table holds it,
    so no effect is added.

    Args:
        values: Free parameters of a fitted model; None is found unless they have such a table.
        loops: The tests.
    """
    at = {s: k for k, s in enumerate(values.symbols)}
    if _SLOPE_AT_0 not in at or _INTERCEPT not in at:
        return None
    sd = np.sqrt(np.maximum(np.diagonal(values.covariance), 0.0))
    others = [k for s, k in at.items() if _SLOPE.fullmatch(s) and s != _SLOPE_AT_0]
    certain = values.values / np.where(sd > 0.0, sd, np.inf)
    rises, fall = float(certain[at[_SLOPE_AT_0]]), [float(certain[k]) for k in others]
    if rises < NORMAL or sum(z < -NORMAL for z in fall) < 2 or max(fall) > NORMAL:
        return None
    confidence = CAP * (1.0 - 2.0 * float(norm.sf(rises)))
    if confidence < UNSURE:
        return None
    kind = effect_kind(MEMBERS[0])
    slope = _quantity(
        "F_y[0 A].slope", "change of the yield force per kelvin at 0 A", "N/K",
        float(values.values[at[_SLOPE_AT_0]]), float(sd[at[_SLOPE_AT_0]]),
    )  # fmt: skip
    toward = np.zeros(len(values.symbols))
    toward[at[_INTERCEPT]], toward[at[_SLOPE_AT_0]] = 1.0, REFERENCE
    level = _quantity(
        kind.facts.size, "friction: yield force at 0 A and 40 °C", "N",
        float(toward @ values.values),
        float(np.sqrt(toward @ values.covariance @ toward)),
    )  # fmt: skip
    return Cause(
        status="class",
        id=MEMBERS[0],
        members=MEMBERS,
        family=kind.facts.family,
        effect=make(kind, max(level.value, 0.0)),
        parameters=(level, slope),
        confidence=round(confidence, 3),
        score=rises**2,
        share=0.0,
        extra_error=float(np.sqrt(np.mean(_force(slope, level, loops) ** 2))),
        because=(
            f"At 0 A the yield force rises with temperature, by {amount(slope)}, while with "
            "current it falls, as that of a fluid does"
        ),
        separating_test=_TEST,
        in_base=True,
    )


def _quantity(symbol: str, name: str, unit: str, value: float, sd: float) -> Quantity:
    half = NORMAL * sd
    return Quantity(symbol, name, value, unit, sd, value - half, value + half, LEVEL)


def _force(slope: Quantity, level: Quantity, loops: Loops) -> np.ndarray:
    """N, at the temperature of each test."""
    return level.value + slope.value * (loops.temperature - REFERENCE)
