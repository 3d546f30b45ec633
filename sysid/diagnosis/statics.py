"""Static forces that a base model holds itself, which therefore no effect can be blamed for."""

from collections.abc import Mapping
from typing import Final

import numpy as np

from sysid.diagnosis.quantities import KNOWN, LEVEL, NORMAL
from sysid.diagnosis.result import Diagnosis, Quantity
from sysid.parameters import specs

HELD: Final[Mapping[str, tuple[tuple[str, str], ...]]] = {
    "tanh": (("f_0", "force_offset"), ("k", "gas_spring")),
    "dahl": (("f_0", "force_offset"), ("k_0", "gas_spring")),
    "bouc_wen": (("f_0", "force_offset"), ("k_0", "gas_spring")),
    "modified_bouc_wen": (("f_0", "force_offset"), ("k_1", "gas_spring")),
    "carreau": (("f_0", "force_offset"), ("k", "gas_spring")),
}
"""Base model → its parameters that are an effect of the catalogue under another name."""


def static_forces(diagnosis: Diagnosis) -> tuple[tuple[str, Quantity], ...]:
    """Id of the effect and the base model's parameter that stands for it, where determined."""
    found = []
    declared = {s.symbol: s for s in specs(diagnosis.damper.valve)}
    sd = np.sqrt(np.maximum(np.diagonal(diagnosis.covariance), 0.0))
    for symbol, effect in HELD.get(diagnosis.base.model, ()):
        k = diagnosis.symbols.index(symbol)
        value, s, spec = float(diagnosis.values[k]), float(sd[k]), declared[symbol]
        known = 0.0 < s < KNOWN * abs(value)
        low, high = value - NORMAL * s, value + NORMAL * s
        quantity = Quantity(symbol, spec.name, value, spec.unit, s, low, high, LEVEL, known)
        # a spring that pushes away from the centre is no gas
        if known and (effect != "gas_spring" or value > 0.0):
            found.append((effect, quantity))
    return tuple(found)
