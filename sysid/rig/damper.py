"""The laboratory's damper: W11 Eqs. 3–9 written once more, apart from `sysid.models`.

It shares no code with the model that is fitted to its data, so that an error in either shows as a
difference between them.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from sysid.rig.elementary import exp, logistic, tanh_half
from sysid.rig.excitation import State

Samples = Float[np.ndarray, " n"]


@dataclass(frozen=True)
class HystereticDamper:
    """A damper that follows W11's generalised model exactly.

    The model has no memory beside the direction of acceleration: at any instant, ramps and rest
    included, the force follows from velocity, sgn ẍ, v_m and current (`State` says how sgn ẍ and
    v_m are formed).

    Attributes:
        parameters: Symbol → value of the 16 parameters, SI.
    """

    parameters: Mapping[str, float]

    def force(self, state: State, current: float | Samples) -> Samples:
        """Force that resists the motion, compression positive, N (W11 Eq. 3).

        Args:
            state: Motion of the piston, arrays [n].
            current: A, constant or [n].

        Source:
            W11 Eqs. 3–9, with k_ve below zero velocity, C_i inside F_b and C_i ≥ 1.
        """
        p = self.parameters
        v, v_m = state.velocity, state.peak_velocity
        current = np.asarray(current, dtype=np.float64)
        gain = np.maximum(1.0, 1.0 + p["k_2"] * self._rise("a_2", "I_0", current))
        width = p["k_4"] * (1.0 + p["k_3"] * self._rise("a_3", "I_1", current))
        transition = p["F_0"] * (1.0 + exp(p["a_1"] * v_m))
        steepness = p["a_0"] / (1.0 + p["k_0"] * v_m)
        shifted = v + state.acceleration_sign * (width * v_m) + p["k_6"] * v_m
        offset = p["k_5"] * gain * transition
        side = np.where(v < 0.0, p["k_1e"], p["k_1c"])
        growth = 1.0 + side * exp(-p["a_4"] * v_m) * np.abs(v)
        return gain * (transition * tanh_half(steepness * shifted) - offset) * growth

    def _rise(self, steepness: str, start: str, current: Samples) -> Samples:
        """σ(a (i + I)) − σ(a I), the current functions of Eqs. 5 and 7."""
        a, offset = self.parameters[steepness], self.parameters[start]
        return logistic(a * (current + offset)) - logistic(np.asarray(a * offset))
