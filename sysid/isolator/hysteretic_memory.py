"""The states of Dahl's and both Bouc–Wen models in a closed loop."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.effects.base import Parts
from sysid.isolator.implicit_stage import onward
from sysid.isolator.memory import AbstractMemory, Moved
from sysid.isolator.plant import Number
from sysid.isolator.root import falling_root
from sysid.models.base import AbstractValve, parts_by_current
from sysid.models.bouc_wen import BoucWen
from sysid.models.current_law import effective_current
from sysid.models.dahl import Dahl
from sysid.models.damper import Damper
from sysid.models.internal_state import bouc_wen_flow, dahl_flow
from sysid.models.modified_bouc_wen import ModifiedBoucWen
from sysid.motion.motion import Motion

_SMALL_TRAVEL = 1e-6
"""m, of the element in series; less need not be known to more than 10⁻⁹ of it."""


class BentValve(AbstractValve):
    r"""Dahl's or Bouc and Wen's valve at an instant, F = c v + k_0 x + f_0 + α w.

    Written out, since the model itself would follow the state of a whole motion.

    Attributes:
        valve: The model.
        w: Its state, −1 to 1.

    Source:
        `sysid.models.dahl`, `sysid.models.bouc_wen`.
    """

    valve: Dahl | BoucWen
    w: Number

    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """Damping force, N."""
        z, s = self.valve, effective_current(motion.current, self.valve.q)
        held = z.k_0 * motion.displacement + z.f_0 + (z.alpha_a + z.alpha_b * s) * self.w
        return (z.c_a + z.c_b * s) * motion.velocity + held

    def parts(self, motion: Motion) -> Parts:
        """Yield part F(i) − F(0 A), viscous part F(0 A)."""
        return parts_by_current(self, motion)


class Hysteresis(AbstractMemory):
    """w of Dahl's or Bouc and Wen's model, which follows the travel of the piston.

    Attributes:
        valve: The model.

    Source:
        `sysid.models.internal_state`.
    """

    valve: Dahl | BoucWen

    def start(self) -> tuple[Number]:
        """As a motion begins in `simulate`."""
        return (jnp.zeros_like(self.valve.rho),)

    def sliding(self, at: Motion) -> tuple[Number]:
        """Yielded."""
        return (jnp.ones_like(self.valve.rho),)

    def reached(self, known: tuple[Number], moved: Moved) -> tuple[Number]:
        """By the travel since the step began."""
        v = self.valve
        flow = dahl_flow(v.rho) if isinstance(v, Dahl) else bouc_wen_flow(v.rho, v.sigma)
        return (flow(known[0], moved.travel),)

    def into(self, damper: Damper, state: tuple[Number]) -> Damper:
        """In the place of the valve."""
        return Damper(BentValve(self.valve, state[0]), damper.effects)


class Element(NamedTuple):
    """Of the element in series: travel u and where it was when the step began, m; w."""

    u: Number
    begun: Number
    w: Number


class ElementLaw(NamedTuple):
    """The element's numbers at a current: α N, c_0 and c_1 N·s/m."""

    alpha: Number
    inner: Number
    outer: Number


class BentSeriesValve(AbstractValve):
    r"""The modified Bouc–Wen valve at an instant.

        F = c_1 (α w + k_0 u + c_0 v) / (c_0 + c_1) + k_1 x + f_0

    Attributes:
        valve: The model.
        element: Its state.
        idle: The state that it would have without any current, whose force is the viscous part.

    Source:
        `sysid.models.modified_bouc_wen`.
    """

    valve: ModifiedBoucWen
    element: Element
    idle: Element

    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """Damping force, N."""
        return self._force(motion, self.element)

    def parts(self, motion: Motion) -> Parts:
        """Yield part F(i) − F(0 A), viscous part F(0 A), each with a state of its own."""
        still = eqx.tree_at(lambda m: m.current, motion, jnp.zeros_like(motion.current))
        viscous = self._force(still, self.idle)
        return Parts(yielding=self.force(motion) - viscous, viscous=viscous)

    def _force(self, motion: Motion, element: Element) -> Float[Array, "*batch n"]:
        law = law_at(self.valve, motion.current)
        share = law.outer / (law.inner + law.outer)
        z = self.valve
        through = law.alpha * element.w + z.k_0 * element.u + law.inner * motion.velocity
        return share * through + z.k_1 * motion.displacement + z.f_0


def law_at(valve: ModifiedBoucWen, current: Number) -> ElementLaw:
    """The element at a current, A."""
    s = effective_current(current, valve.q)
    return ElementLaw(
        valve.alpha_a + valve.alpha_b * s,
        valve.c_0a + valve.c_0b * s,
        valve.c_1a + valve.c_1b * s,
    )


class SeriesHysteresis(AbstractMemory):
    r"""u and w of the modified Bouc–Wen model.

        (c_0 + c_1) u̇ = c_1 v − α w − k_0 u

    A stage u = K + g u̇ is one equation for u, in which w has moved by its exact flow from where
    the step began; it rises with u, so it has one root.

    Attributes:
        valve: The model.
        lawful: Laws act on its parts, so the state without current is carried, too.

    Source:
        `sysid.models.modified_bouc_wen`.
    """

    valve: ModifiedBoucWen
    lawful: bool = eqx.field(static=True)

    def start(self) -> tuple[Element, ...]:
        """As a motion begins in `simulate`."""
        none = jnp.zeros_like(self.valve.rho)
        return (Element(none, none, none),) * (2 if self.lawful else 1)

    def sliding(self, at: Motion) -> tuple[Element, ...]:
        """Yielded, and u in its middle: it follows a steady speed for seconds, to no purpose."""
        none = jnp.zeros_like(self.valve.rho)
        return (Element(none, none, none + 1.0),) * (2 if self.lawful else 1)

    def reached(self, known: tuple[Element, ...], moved: Moved) -> tuple[Element, ...]:
        """By an implicit stage."""
        currents = (moved.current, jnp.zeros_like(moved.current))
        return tuple(
            self._stage(element, moved, law_at(self.valve, current))
            for element, current in zip(known, currents, strict=False)
        )

    def carried(
        self, begin: tuple[Element, ...], first: tuple[Element, ...]
    ) -> tuple[Element, ...]:
        """Travel is integrated as all else is; w counts from where the step began."""
        return tuple(b._replace(u=onward(b.u, f.u)) for b, f in zip(begin, first, strict=True))

    def into(self, damper: Damper, state: tuple[Element, ...]) -> Damper:
        """In the place of the valve."""
        return Damper(BentSeriesValve(self.valve, state[0], state[-1]), damper.effects)

    def _stage(self, known: Element, moved: Moved, law: ElementLaw) -> Element:
        g, k = moved.length, self.valve.k_0
        viscosity = law.inner + law.outer
        inert = viscosity + g * k
        push = viscosity * (known.u - known.begun) + g * (
            law.outer * moved.velocity - k * known.begun
        )
        flow = bouc_wen_flow(self.valve.rho, self.valve.sigma)
        drive, share = push / inert, g * law.alpha / inert
        held_drive, held_share = jax.lax.stop_gradient((drive, share))

        def lacking(run: Number) -> tuple[Number, Number]:
            w = flow(known.w, run)
            return held_drive - held_share * w - run, -held_share * self._rate(run, w) - 1.0

        first = held_drive - held_share * known.w
        run = jax.lax.stop_gradient(falling_root(lacking, first, _SMALL_TRAVEL))
        slope = lacking(run)[1]
        # a last step with a fixed slope carries the derivatives of the root
        run = run - (drive - share * flow(known.w, run) - run) / slope
        u = known.begun + run
        return Element(u, u, flow(known.w, run))

    def _rate(self, run: Number, w: Number) -> Number:
        """dw/du in the direction of a run, 1/m."""
        y = jnp.where(run >= 0.0, w, -w)
        return self.valve.rho * (
            1.0 + jnp.where(y < 0.0, 2.0 * self.valve.sigma - 1.0, -1.0) * y * y
        )
