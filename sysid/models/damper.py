"""The signal path: a valve model with effects around it."""

from collections.abc import Sequence
from functools import reduce
from operator import add
from typing import TypeAlias

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.effects.base import (
    AbstractChannelEffect,
    AbstractDriveEffect,
    AbstractEffect,
    AbstractForceEffect,
    AbstractLawEffect,
    AbstractMotionEffect,
    Behind,
    Changes,
    Force,
    Parts,
    ValveParts,
)
from sysid.effects.fourier import refined
from sysid.effects.leak import parts_beside_leak
from sysid.effects.motion.series_compliance import (
    FINEST,
    SeriesCompliance,
    change_behind,
    moved_by,
)
from sysid.effects.travel import mean_force
from sysid.models.base import AbstractInnerValve, AbstractModel, AbstractValve
from sysid.motion.motion import Motion

Laws: TypeAlias = Sequence[AbstractLawEffect]


class Damper(AbstractModel):
    """A valve model and a tuple of effects on the signal path; adding one gives a new Damper.

    drive → motion → law → force → channel.  Within a stage effects act in the order of the tuple;
    motion effects nest, the first one nearest to the rig, and leaks come after all other laws.  A
    valve that takes changes into its own equations (`AbstractInnerValve`) takes springs, too.

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
        if isinstance(
            self.valve, AbstractInnerValve
        ):  # in a chain in series, springs may as well stand at its end
            moving = [e for e in moving if not isinstance(e, SeriesCompliance)]
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
        """Valve with its laws and leaks, and the gas and other forces in parallel."""
        spring = self._own_spring()
        if spring is not None:
            return self._behind_spring(spring, motion)
        laws, leakage = self._laws_and_leakage(motion)

        def through(m: Motion) -> Force:
            if leakage is not None:
                return parts_beside_leak(m, self._parts(laws), leakage).total
            return self._parts(laws)(m).total if laws else self.valve.without_gas(m)

        # a valve with memory follows the mean motion about each sample
        force = mean_force(motion, through) if self.valve.memoryless else through(motion)
        return self._with_parallel(force, motion)

    def _own_spring(self) -> SeriesCompliance | None:
        """All springs in series with the valve, as one, if it takes such into its equations."""
        springs = [e for e in self.effects if isinstance(e, SeriesCompliance)]
        if not springs or not isinstance(self.valve, AbstractInnerValve):
            return None
        return SeriesCompliance(reduce(add, [e.s_k for e in springs]))

    def _behind_spring(self, spring: SeriesCompliance, motion: Motion) -> Force:
        """Valve and forces in parallel behind a spring that the valve takes.

        Of friction and the like, P, the valve feels no more than that the spring gives by s P.  So
        P is found first, beside the force of the valve alone and on a grid as fine as that of other
        springs, and then the valve anew.  A leak that goes by travel since a reversal goes by that
        behind the spring.
        """
        parallel = [e for e in self.effects if isinstance(e, AbstractForceEffect)]
        leakage = self._laws_and_leakage(motion)[1]
        if not parallel and (leakage is None or jnp.ndim(leakage) == 0):
            return self._with_spring(spring, motion, leakage)
        times = -(-FINEST // motion.velocity.shape[-1]) if motion.periodic else 1
        fine = refined(motion, times) if motion.periodic else motion
        leakage = self._laws_and_leakage(fine)[1]
        change = change_behind(fine, spring.s_k, self._with_spring(spring, fine, leakage))
        inner = moved_by(fine, change)
        beside = jnp.zeros_like(motion.velocity)
        if parallel:
            inner = spring.at_valve(inner, self._parallel)
            force = self._parallel(inner)
            x, v, a = (z[..., ::times] for z in change_behind(fine, spring.s_k, force))
            motion, beside = moved_by(motion, (x, v, a)), force[..., ::times]
        leakage = self._laws_and_leakage(inner)[1]
        if leakage is not None and jnp.ndim(leakage) > 0:
            leakage = leakage[..., ::times]
        return self._with_spring(spring, motion, leakage) + beside

    def _with_spring(
        self, spring: SeriesCompliance, motion: Motion, leakage: Float[Array, "..."] | None
    ) -> Force:
        """Force of the valve alone, with its laws, leaks and spring."""
        parts = self._parts(self._laws_and_leakage(motion)[0])
        return parts.changed(motion, Changes(leakage=leakage, compliance=spring.s_k)).total

    def _parallel(self, motion: Motion) -> Force:
        """Forces beside the valve alone."""
        return self._with_parallel(jnp.zeros_like(motion.velocity), motion)

    def _within_leaks(self, motion: Motion) -> tuple[Force, Force]:
        """Velocity that valve and leaks take up, and the force, for a motion at the valve."""
        laws, leakage = self._laws_and_leakage(motion)
        if leakage is None or isinstance(self.valve, AbstractInnerValve):
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

    def _parts(self, laws: Laws) -> ValveParts:
        valve = self.valve
        inside = valve.parts_changed if isinstance(valve, AbstractInnerValve) else None
        return reduce(_changed, laws, ValveParts(valve.parts, inside, valve.thermal))

    def _with_parallel(self, force: Force, motion: Motion) -> Force:
        """A force through the valve, and the gas and other forces beside it."""
        gas = self.valve.gas_force(motion)
        if gas is not None:
            force = force + gas
        for effect in self.effects:
            if isinstance(effect, AbstractForceEffect):
                force = force + effect.force(motion)
        return force


def _changed(valve: ValveParts, law: AbstractLawEffect) -> ValveParts:
    """The parts behind a law; what is changed after it is changed inside, ahead of the law."""

    def parts(motion: Motion) -> Parts:
        return law.parts(motion, valve)

    inside = valve.inside
    if inside is None:
        return ValveParts(parts, thermal=valve.thermal)

    def changed(motion: Motion, changes: Changes) -> Parts:
        already = ValveParts(
            lambda m: inside(m, changes),
            lambda m, more: inside(m, changes.also(more)),
            valve.thermal,
        )
        return law.parts(motion, already)

    return ValveParts(parts, changed, valve.thermal)
