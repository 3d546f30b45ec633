"""The signal path: a valve model with effects around it."""

from collections.abc import Callable, Sequence
from functools import reduce
from typing import TypeAlias

import equinox as eqx
from jaxtyping import Array, Float

from sysid.effects.base import (
    AbstractChannelEffect,
    AbstractDriveEffect,
    AbstractEffect,
    AbstractForceEffect,
    AbstractLawEffect,
    AbstractMotionEffect,
    Behind,
    Force,
    Parts,
)
from sysid.effects.leak import parts_beside_leak
from sysid.models.base import AbstractModel, AbstractValve
from sysid.motion.motion import Motion

Laws: TypeAlias = Sequence[AbstractLawEffect]


class Damper(AbstractModel):
    """A valve model and a tuple of effects on the signal path; adding one gives a new Damper.

    drive → motion → law → force → channel.  Within a stage effects act in the order of the tuple;
    motion effects nest, the first one nearest to the rig, and leaks come after all other laws.

    Attributes:
        valve: The base model.
        effects: Any number, of any stages.
    """

    valve: AbstractValve
    effects: tuple[AbstractEffect, ...] = ()

    def with_effect(self, effect: AbstractEffect) -> "Damper":
        """This damper and one more effect."""
        return Damper(self.valve, (*self.effects, effect))

    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """Recorded force on a motion, N, positive when it resists compression."""
        for effect in self.effects:
            if isinstance(effect, AbstractDriveEffect):
                motion = eqx.tree_at(lambda m: m.current, motion, effect.current(motion))
        moving = [e for e in self.effects if isinstance(e, AbstractMotionEffect)]
        force = self._through(moving, motion)
        for effect in self.effects:
            if isinstance(effect, AbstractChannelEffect):
                force = effect.recorded(force, motion)
        return force

    def _through(self, moving: Sequence[AbstractMotionEffect], motion: Motion) -> Force:
        """Force at the end of a chain of motion effects."""
        if not moving:
            return self._at_valve(motion)
        behind = moving[1:]

        def within(inner: Motion) -> tuple[Force, Force]:
            if behind:
                return inner.velocity, self._through(behind, inner)
            return self._within_leaks(inner)

        inner = moving[0].at_valve(motion, Behind(lambda m: self._through(behind, m), within))
        return moving[0].carried(self._through(behind, inner), motion)

    def _at_valve(self, motion: Motion) -> Force:
        """Valve with its laws and leaks, and the forces in parallel."""
        laws, leakage = self._laws_and_leakage(motion)
        if leakage is not None:
            force = parts_beside_leak(motion, self._parts(laws), leakage).total
        else:
            force = self._parts(laws)(motion).total if laws else self.valve.force(motion)
        return self._with_parallel(force, motion)

    def _within_leaks(self, motion: Motion) -> tuple[Force, Force]:
        """Velocity that valve and leaks take up, and the force, for a motion at the valve."""
        laws, leakage = self._laws_and_leakage(motion)
        if leakage is None:
            return motion.velocity, self._at_valve(motion)
        force = self._parts(laws)(motion).total
        velocity = motion.velocity + leakage * force
        outer = eqx.tree_at(lambda m: m.velocity, motion, velocity)
        return velocity, self._with_parallel(force, outer)

    def _laws_and_leakage(self, motion: Motion) -> tuple[Laws, Float[Array, "..."] | None]:
        """Laws that are no leaks, and all leaks together, m/(s·N)."""
        laws, leakage = [], None
        for law in (e for e in self.effects if isinstance(e, AbstractLawEffect)):
            own = law.leakage(motion)
            if own is None:
                laws.append(law)
            else:
                leakage = own if leakage is None else leakage + own
        return laws, leakage

    def _parts(self, laws: Laws) -> Callable[[Motion], Parts]:
        return reduce(_changed, laws, self.valve.parts)

    def _with_parallel(self, force: Force, motion: Motion) -> Force:
        for effect in self.effects:
            if isinstance(effect, AbstractForceEffect):
                force = force + effect.force(motion)
        return force


def _changed(valve: Callable[[Motion], Parts], law: AbstractLawEffect) -> Callable[[Motion], Parts]:
    return lambda motion: law.parts(motion, valve)
