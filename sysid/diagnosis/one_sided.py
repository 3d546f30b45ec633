r"""Friction in one direction only, which no cycle tells from friction with an offset as large.

A seal that grips with F while the rod moves one way, and not at all the other way, gives

    F/2 + F/2 sgn v,

which is a constant force and friction in both directions.  Two causes would be as large as each
other by chance alone; what is that improbable is no evidence for two.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from sysid.diagnosis.quantities import free_values
from sysid.diagnosis.state import State

OFFSET: Final = "force_offset"
FRICTION: Final = {"seal_friction": "F_c", "presliding_friction": "F_ps"}
"""Friction that does not depend on speed: symbol of its size."""
TEST: Final = (
    "The force on the rod held still after a slow stroke one way and after one the other way, and "
    "the load cell's zero with the rod disconnected"
)


@dataclass(frozen=True)
class OneSided:
    """An offset and a friction that may be one.

    Attributes:
        friction: Id of the friction.
        offset: N.
        size: Of the friction, N.
        odds: Logarithm of how much more probable the two sizes are if they are one.
    """

    friction: str
    offset: float
    size: float
    odds: float

    @property
    def words(self) -> str:
        """What a user should know of it."""
        return (
            f"A constant force of {self.offset:.3g} N was found, as large as the friction "
            f"({self.size:.3g} N): friction in one direction only is exactly that, so the "
            "constant force is not called a cause of its own."
        )


def one_sided(state: State) -> OneSided | None:
    """The offset and the friction of a model, if they are more probably one than two.

    One makes the sizes equal, to within what they are known, d ± s; two leave the offset anywhere
    between −2 F and 2 F, F being the friction, so that ln(odds) = ln(2F / (√(2π) s)) − d²/2s².

    Args:
        state: A model with effects, fitted.
    """
    found = [kind for kind in state.ids if kind in FRICTION]
    if OFFSET not in state.ids or len(found) != 1:
        return None
    values = free_values(state)
    places = [
        values.symbols.index(s) for s in (f"{OFFSET}.F_off", f"{found[0]}.{FRICTION[found[0]]}")
    ]
    offset, size = (float(values.values[k]) for k in places)
    slope = np.array([np.sign(offset), -1.0])
    variance = float(slope @ values.covariance[np.ix_(places, places)] @ slope)
    odds = log_odds(offset, size, float(np.sqrt(max(variance, 0.0))))
    return OneSided(found[0], offset, size, odds) if odds > 0.0 else None


def log_odds(offset: float, size: float, deviation: float) -> float:
    """How much more probable two sizes are if they are one, natural logarithm.

    Args:
        offset: N, of either sign.
        size: N, of the friction.
        deviation: N, standard deviation of |offset| − size.
    """
    if size <= 0.0 or deviation <= 0.0:
        return -np.inf
    apart = (abs(offset) - size) / deviation
    return float(np.log(2.0 * size / (np.sqrt(2.0 * np.pi) * deviation)) - 0.5 * apart**2)
