"""The signal path: a valve model with effects around it."""

from collections.abc import Callable, Sequence
from functools import reduce

import equinox as eqx
from jaxtyping import Array, Float

from sysid.effects.base import (
    AbstractChannelEffect,
    AbstractDriveEffect,
    AbstractEffect,
    AbstractForceEffect,
    AbstractLawEffect,
    AbstractMotionEffect,
    Force,
    Parts,
)
from sysid.models.base import AbstractModel, AbstractValve
from sysid.motion.motion import Motion


class Damper(AbstractModel):
    """A valve model and a tuple of effects on the signal path; adding one gives a new Damper.

    drive → motion → law → force → channel.  Within a stage effects act in the order of the tuple;
    motion effects nest, the first one nearest to the rig.

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
        inner = moving[0].at_valve(motion, lambda m: self._through(behind, m))
        return self._through(behind, inner)

    def _at_valve(self, motion: Motion) -> Force:
        """Valve with its laws, and the forces in parallel."""
        laws = [e for e in self.effects if isinstance(e, AbstractLawEffect)]
        parts: Callable[[Motion], Parts] = reduce(_changed, laws, self.valve.parts)
        force = parts(motion).total if laws else self.valve.force(motion)
        for effect in self.effects:
            if isinstance(effect, AbstractForceEffect):
                force = force + effect.force(motion)
        return force


def _changed(valve: Callable[[Motion], Parts], law: AbstractLawEffect) -> Callable[[Motion], Parts]:
    return lambda motion: law.parts(motion, valve)
