"""The lumped model's element in a closed loop with laws, a leak or a spring around it."""

from typing import Literal, NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.effects.base import AbstractEffect, Changes, Parts
from sysid.isolator.implicit_stage import onward
from sysid.isolator.lumped_step import element_velocity
from sysid.isolator.memory import AbstractMemory, Moved
from sysid.isolator.plant import Number
from sysid.models.base import AbstractInnerValve, AbstractValve
from sysid.models.damper import Damper
from sysid.models.lumped import Lumped, Warmth
from sysid.motion.motion import Motion

_STEADY = 1e3
"""s, of a stage so long that only what lasts is left."""


class ElementForce(NamedTuple):
    """Force of the spring, N, and velocity of the element, m/s."""

    force: Number
    w: Number


class StagedElement(AbstractInnerValve):
    r"""The element at the end of a stage, with whatever laws change in it.

        F = F_K + g k (v − l F − w),    m_l w = m_l w_K + g (F − χ(w))

    Laws, leaks and springs come as `Changes` of its numbers, as they do in `simulate`, so that
    each acts here as it does there.

    Attributes:
        valve: The model.
        warmth: °C at which its laws are read; None for the motion's own.
        known: F_K and w_K.
        length: g, s.
        told: What it gives as its force: F in N, or w in m/s, which laws hand on as it is.

    Source:
        `sysid.models.lumped`, `sysid.models.biviscous`.
    """

    valve: Lumped
    warmth: Warmth | None
    known: ElementForce
    length: Number
    told: Literal["force", "w"] = eqx.field(static=True)

    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """F or w."""
        return self.parts(motion).total

    def parts(self, motion: Motion) -> Parts:
        """Without changes."""
        return self.parts_changed(motion, Changes())

    def parts_changed(self, motion: Motion, changes: Changes) -> Parts:
        """F or w as one part; laws of such a valve change its numbers and add nothing."""
        warmth = self.warmth
        element = self.valve.changed_element(
            self.valve.element(motion, None if warmth is None else lambda _: warmth), changes
        )
        g, k = self.length, element.stiffness
        give = 1.0 / (1.0 + g * element.relief)
        soft, begin = g * k * give, (self.known.force + g * k * motion.velocity) * give
        w = element_velocity(
            element.mass * self.known.w + g * begin, element.mass + g * soft, g,
            element.pre, element.post, element.yielding,
        )  # fmt: skip
        told = w if self.told == "w" else begin - soft * w
        return Parts(yielding=told, viscous=jnp.zeros_like(told))


class HeldElement(AbstractValve):
    """The element with a force that is known.

    Attributes:
        state: It.

    Source:
        `StagedElement`.
    """

    state: ElementForce

    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """Force of the spring, N."""
        return self.state.force + 0.0 * motion.velocity

    def parts(self, motion: Motion) -> Parts:
        """As one part: laws have acted already."""
        return Parts(yielding=self.force(motion), viscous=0.0 * motion.velocity)


class ElementMemory(AbstractMemory):
    """Force and velocity of the lumped model's element.

    Attributes:
        valve: The model.
        inside: Laws, leaks and a spring, which change its numbers.
        warmth: °C at which C_post, F_y and k are read; None for the temperature of the step.
    """

    valve: Lumped
    inside: tuple[AbstractEffect, ...] = ()
    warmth: Warmth | None = None

    def start(self) -> ElementForce:
        """Relaxed."""
        none = jnp.zeros_like(self.valve.m_l)
        return ElementForce(none, none)

    def sliding(self, at: Motion) -> ElementForce:
        """At the piston's own speed."""
        none, steady = jnp.zeros_like(self.valve.m_l), at.velocity[0]
        long = Moved(none, none + _STEADY, at)
        return self.reached(ElementForce(none, steady), long)

    def reached(self, known: ElementForce, moved: Moved) -> ElementForce:
        """By an implicit stage, solved exactly."""

        def told(what: Literal["force", "w"]) -> Number:
            staged = StagedElement(self.valve, self.warmth, known, moved.length, what)
            return Damper(staged, self.inside).force(moved.end)[0]

        return ElementForce(told("force"), told("w"))

    def carried(self, begin: ElementForce, first: ElementForce) -> ElementForce:
        """Both are integrated."""
        return ElementForce(*map(onward, begin, first))

    def into(self, damper: Damper, state: ElementForce) -> Damper:
        """In the place of the valve."""
        return Damper(HeldElement(state), damper.effects)
