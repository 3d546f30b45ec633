"""Questions made by hand: a damper of the papers with effects around it."""

import numpy as np

from sysid.diagnosis.questions import Alternative, Open, Question
from sysid.effects.registry import effect_kind, make
from sysid.likelihood.discrepancy import Sizes
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.parameters import build
from sysid.planning.limits import Conditions

VALVE = build(Generalized, LOW_SYMMETRIC)
FREE = ("F_0", "I_0", "I_1", "k_0")
"""Parameters of the valve that the old tests know to 1 %."""
SIZES = Sizes(gain=0.006, offset=2.0, delay=1e-4, odd=1e-4, even=1e-4)
NOISE = 0.2
DONE = Conditions((0.0025, 0.025), (1.5, 1.5), (0.0, 0.2, 0.4), 40.0, 0.025, 0.24)


def alternative(id: str, size: float | None = None) -> Alternative:
    """The damper with an effect, whose size is known to 10 %."""
    kind = effect_kind(id)
    effect = make(kind) if size is None else make(kind, size)
    value = float(getattr(effect, kind.facts.size))
    symbols = (*FREE, f"{id}.{kind.facts.size}")
    sd = [0.01 * abs(LOW_SYMMETRIC[s]) for s in FREE] + [0.1 * abs(value)]
    return Alternative((id,), Damper(VALVE, (effect,)), symbols, (), np.diag(np.square(sd)))


def a_class(*ids: str, **sizes: float) -> Open:
    """A class of such effects."""
    every = tuple(alternative(id, sizes.get(id)) for id in ids)
    return Open((Question("class", ids, every),), (), SIZES, NOISE)
