"""The states of Dahl's and both Bouc–Wen models in a closed loop."""

from typing import Literal, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.effects.base import AbstractEffect, Changes, Parts
from sysid.isolator.implicit_stage import onward
from sysid.isolator.memory import AbstractMemory, Moved
from sysid.isolator.plant import Number
from sysid.isolator.root import falling_root
from sysid.models.base import AbstractInnerValve, parts_by_current
from sysid.models.bouc_wen import BoucWen
from sysid.models.dahl import Dahl
from sysid.models.damper import Damper
from sysid.models.modified_bouc_wen import ModifiedBoucWen
from sysid.models.series_parts import element_of, parts_at
from sysid.models.series_state import Followed, SeriesElement
from sysid.motion.motion import Motion

_SMALL_TRAVEL = 1e-6
"""m, of the element in series; less need not be known to more than 10⁻⁹ of it."""


class ToldFactor(AbstractInnerValve):
    """Gives as its force what laws make of one of its numbers.

    Attributes:
        factor: Which one.

    Source:
        `sysid.effects.base.Changes`.
    """

    factor: Literal["yielding", "viscous", "stiffness"] = eqx.field(static=True)

    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """One: no law, no change."""
        return self.parts(motion).total

    def parts(self, motion: Motion) -> Parts:
        """Without changes."""
        return self.parts_changed(motion, Changes())

    def parts_changed(self, motion: Motion, changes: Changes) -> Parts:
        """The factor as one part."""
        none = jnp.zeros_like(motion.velocity)
        return Parts(yielding=getattr(changes, self.factor) + none, viscous=none)


def changes_by(laws: tuple[AbstractEffect, ...], motion: Motion) -> Changes:
    """What laws change in a valve at an instant, numbers each.

    Args:
        laws: Of the damper; no leaks.
        motion: One point, [1].
    """
    if not laws:
        return Changes()

    def told(factor: Literal["yielding", "viscous", "stiffness"]) -> Number:
        return Damper(ToldFactor(factor), laws).force(motion)[0]

    return Changes(told("yielding"), told("viscous"), told("stiffness"))


class BentValve(AbstractInnerValve):
    r"""A valve with hysteresis at an instant, the state of its element as it is.

    Written out, since the model itself would follow the state of a whole motion.

    Attributes:
        valve: The model.
        u: Travel of the element, m; of no meaning where it has no spring.
        w: Its state, −1 to 1.

    Source:
        `sysid.models.series_parts`.
    """

    valve: Dahl | BoucWen | ModifiedBoucWen
    u: Number
    w: Number

    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """Damping force, N."""
        return self.parts_changed(motion, Changes()).total

    def parts(self, motion: Motion) -> Parts:
        """Yield part F(i) − F(0 A), viscous part F(0 A)."""
        return parts_by_current(self, motion)

    def parts_changed(self, motion: Motion, changes: Changes) -> Parts:
        """The parts with changes."""
        law = self.valve.series_law(motion.current)
        rate = element_of(law, changes).rate_at(motion.velocity, self.u, self.w)
        return parts_at(law, motion, changes, Followed(self.u, self.w, rate, ()))


class Hysteresis(AbstractMemory):
    """w of Dahl's or Bouc and Wen's model, which follows the travel of the piston.

    Attributes:
        valve: The model.
        laws: That change its numbers.

    Source:
        `sysid.models.internal_state`.
    """

    valve: Dahl | BoucWen
    laws: tuple[AbstractEffect, ...] = ()

    def start(self) -> tuple[Number]:
        """As a motion begins in `simulate`."""
        return (jnp.zeros_like(self.valve.rho),)

    def sliding(self, at: Motion) -> tuple[Number]:
        """Yielded."""
        return (jnp.ones_like(self.valve.rho),)

    def reached(self, known: tuple[Number], moved: Moved) -> tuple[Number]:
        """By the travel since the step began."""
        element = element_of(self.valve.series_law(moved.current), changes_by(self.laws, moved.end))
        return (element.flow(element.rho)(known[0], moved.travel),)

    def into(self, damper: Damper, state: tuple[Number]) -> Damper:
        """In the place of the valve."""
        return Damper(BentValve(self.valve, jnp.zeros_like(state[0]), state[0]), damper.effects)


class Element(NamedTuple):
    """Of the element in series: travel u and where it was when the step began, m; w."""

    u: Number
    begun: Number
    w: Number


class SeriesHysteresis(AbstractMemory):
    r"""u and w of the modified Bouc–Wen model.

        (1 + c_0 μ) u̇ = v − μ (α w + k_0 u),    μ = 1/c_1

    A stage u = K + g u̇ is one equation for u, in which w has moved by its exact flow from where
    the step began; it rises with u, so it has one root.

    Attributes:
        valve: The model.
        laws: That change its numbers.

    Source:
        `sysid.models.modified_bouc_wen`.
    """

    valve: ModifiedBoucWen
    laws: tuple[AbstractEffect, ...] = ()

    def start(self) -> Element:
        """As a motion begins in `simulate`."""
        none = jnp.zeros_like(self.valve.rho)
        return Element(none, none, none)

    def sliding(self, at: Motion) -> Element:
        """Yielded, and u in its middle: it follows a steady speed for seconds, to no purpose."""
        none = jnp.zeros_like(self.valve.rho)
        return Element(none, none, none + 1.0)

    def reached(self, known: Element, moved: Moved) -> Element:
        """By an implicit stage."""
        changes = changes_by(self.laws, moved.end)
        return _stage(known, moved, element_of(self.valve.series_law(moved.current), changes))

    def carried(self, begin: Element, first: Element) -> Element:
        """Travel is integrated as all else is; w counts from where the step began."""
        return begin._replace(u=onward(begin.u, first.u))

    def into(self, damper: Damper, state: Element) -> Damper:
        """In the place of the valve."""
        return Damper(BentValve(self.valve, state.u, state.w), damper.effects)


def _stage(known: Element, moved: Moved, element: SeriesElement) -> Element:
    g, mu, rho = moved.length, element.mobility, element.rho
    whole = 1.0 + element.inner * mu
    inert = whole + g * mu * element.held(jnp.ones_like(g))
    push = whole * (known.u - known.begun) + g * (moved.velocity - mu * element.held(known.begun))
    flow = element.flow(rho)
    drive, share = push / inert, g * mu * element.yielding / inert
    held_drive, held_share = jax.lax.stop_gradient((drive, share))

    def lacking(run: Number) -> tuple[Number, Number]:
        w = flow(known.w, run)
        return held_drive - held_share * w - run, -held_share * element.rate(rho, run, w) - 1.0

    first = held_drive - held_share * known.w
    run = jax.lax.stop_gradient(falling_root(lacking, first, _SMALL_TRAVEL))
    slope = lacking(run)[1]
    # a last step with a fixed slope carries the derivatives of the root
    run = run - (drive - share * flow(known.w, run) - run) / slope
    u = known.begun + run
    return Element(u, u, flow(known.w, run))
