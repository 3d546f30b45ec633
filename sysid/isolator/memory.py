"""What a damper in a closed loop remembers of the travel of its piston."""

from abc import abstractmethod
from typing import Any, NamedTuple

import equinox as eqx
import jax.numpy as jnp

from sysid.effects.base import AbstractForceEffect, Force
from sysid.effects.force.presliding_friction import PreslidingFriction
from sysid.effects.force.stribeck_friction import StribeckFriction
from sysid.isolator.plant import Number
from sysid.models.damper import Damper
from sysid.models.internal_state import dahl_flow
from sysid.motion.motion import Motion

_SMALLEST = 1e-12
"""m; a bristle that bends less turns over at once, as in `sysid.effects.bristle`."""


class Moved(NamedTuple):
    """What happened to the piston up to the end of a stage.

    Attributes:
        travel: Since the step began, m.
        length: g of the stage, s.
        end: Motion and current at the end, all arrays [1].
    """

    travel: Number
    length: Number
    end: Motion

    @property
    def velocity(self) -> Number:
        """At the end, m/s."""
        return self.end.velocity[0]

    @property
    def current(self) -> Number:
        """At the end, A."""
        return self.end.current[0]


def instant(
    x: Number, v: Number, a: Number, side: Number, current: Number, temperature: Number
) -> Motion:
    """A motion of one point.

    Args:
        x: m.
        v: m/s.
        a: m/s².
        side: Sign of the acceleration that the damper feels.
        current: A.
        temperature: °C.
    """
    square = v * v - a * x
    moving = square > 0.0
    peak = jnp.where(moving, jnp.sqrt(jnp.where(moving, square, 1.0)), 0.0)
    one = [jnp.reshape(z, (1,)) for z in (x, v, a, side, peak, current, temperature)]
    still = jnp.zeros(1)
    return Motion(*one, time=still, frequency=still + jnp.nan, periodic=False)


class AbstractMemory(eqx.Module):
    """A state beside the instant, and the valve or effect that has it.

    A state that follows travel has moved by its exact flow from where the step began, however
    stiff it is: so it stays within its bounds, and within a step the damper is to the plant a
    force that depends on place, velocity and time alone.
    """

    @abstractmethod
    def start(self) -> Any:
        """At rest: a tuple of numbers."""

    @abstractmethod
    def sliding(self, at: Motion) -> Any:
        """After so long a way in compression that the past is forgotten.

        Args:
            at: The steady motion, [1].
        """

    @abstractmethod
    def reached(self, known: Any, moved: Moved) -> Any:
        """At the end of a stage.

        Args:
            known: What `carried` or the last step left.
            moved: Of the piston.
        """

    @abstractmethod
    def into(self, damper: Damper, state: Any) -> Damper:
        """The damper as it is at an instant with this state."""

    def carried(self, begin: Any, first: Any) -> Any:
        """What the second stage starts from: for exact flows, where the step began.

        Args:
            begin: At the start of the step.
            first: At the end of the first stage.
        """
        return begin


class BentFriction(AbstractForceEffect):
    """Presliding or Stribeck friction with its bristle bent as far as it is.

    Attributes:
        effect: The friction.
        bent: −1 to 1.

    Source:
        `sysid.effects.force.presliding_friction`, `sysid.effects.force.stribeck_friction`.
    """

    effect: PreslidingFriction | StribeckFriction
    bent: Number

    def force(self, motion: Motion) -> Force:
        """Friction, N."""
        if isinstance(self.effect, PreslidingFriction):
            return self.effect.F_ps * self.bent + 0.0 * motion.velocity
        fallen = jnp.exp(-((motion.velocity / self.effect.v_st) ** 2))
        return self.effect.F_s * fallen * self.bent


class Bristle(AbstractMemory):
    r"""The bristle of presliding or Stribeck friction.

        dy/|dx| = (sgn v − y) / ℓ,    ℓ = F/σ_0

    Attributes:
        effect: The friction.

    Source:
        P. R. Dahl (1968), as `sysid.effects.bristle`.
    """

    effect: PreslidingFriction | StribeckFriction

    @property
    def _carried(self) -> Number:
        e = self.effect
        return e.F_ps if isinstance(e, PreslidingFriction) else e.F_s

    def start(self) -> tuple[Number]:
        """Relaxed."""
        return (jnp.zeros_like(self._carried),)

    def sliding(self, at: Motion) -> tuple[Number]:
        """Bent all the way."""
        return (jnp.ones_like(self._carried),)

    def reached(self, known: tuple[Number], moved: Moved) -> tuple[Number]:
        """Bent by the travel since the step began."""
        travel = jnp.maximum(self._carried / self.effect.sigma_0, _SMALLEST)
        return (dahl_flow(1.0 / travel)(known[0], moved.travel),)

    def into(self, damper: Damper, state: tuple[Number]) -> Damper:
        """Beside the valve."""
        return damper.with_effect(BentFriction(self.effect, state[0]))
