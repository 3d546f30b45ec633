"""PID skyhook control with force feedback and integral reset."""

from typing import Final, NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Bool

from sysid.isolator.controllers.base import AbstractController
from sysid.isolator.plant import Number
from sysid.isolator.skyhook import Sensed, along, demand, dissipative

GAINS: Final = (5e-4, 0.2, 3.13e-7)
"""K_p A/N, K_i A/(N s), K_d A s/N of BS09, which its authors tuned by Ziegler and Nichols."""


class Memory(NamedTuple):
    """Of a PID controller.

    Attributes:
        integral: Of the error, N·s.
        error: At the last sample, N.
        on: The skyhook's force took energy out then.
        begun: There was a sample.
    """

    integral: Number
    error: Number
    on: Bool[Array, "..."]
    begun: Bool[Array, "..."]


class Pid(AbstractController):
    """I = K_p e + K_i ∫e + K_d ė with e = F_d − F in the direction of motion (BS09 Eq. 3).

    0 by Eq. 2; where that condition changes, the integral starts from zero.

    Attributes:
        damping: D, N·s/m.
        gain: K_p, A/N.
        integral: K_i, A/(N s).
        derivative: K_d, A s/N.
    """

    damping: Number
    gain: Number
    integral: Number
    derivative: Number

    def start(self) -> Memory:
        """Empty."""
        none, no = jnp.zeros_like(self.damping), jnp.zeros(self.damping.shape, dtype=bool)
        return Memory(none, none, no, no)

    def command(self, memory: Memory, sensed: Sensed, period: Number) -> tuple[Memory, Number]:
        """Sampled, with the error's change since the last sample as its derivative."""
        error = along(demand(self.damping, sensed) - sensed.force, sensed)
        on = dissipative(sensed)
        kept = memory.begun & (on == memory.on)
        rate = jnp.where(kept, (error - memory.error) / period, 0.0)
        area = jnp.where(kept, memory.integral + 0.5 * period * (error + memory.error), 0.0)
        current = self.gain * error + self.integral * area + self.derivative * rate
        after = Memory(area, error, on, jnp.ones_like(memory.begun))
        return after, jnp.where(on, current, 0.0)


def pid(damping: Number, gains: tuple[float, float, float] = GAINS) -> Pid:
    """With the paper's gains unless told otherwise."""
    return Pid(damping, *(jnp.asarray(z) for z in gains))
