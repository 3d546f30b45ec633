"""The temperature-dependent lumped model of Batterbee and Sims (2009)."""

from collections.abc import Callable
from typing import ClassVar, Final, NamedTuple, TypeAlias

import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.effects.base import Changes, Parts
from sysid.effects.causal import lagged
from sysid.effects.reference_temperature import REFERENCE, excess_temperature
from sysid.models.base import AbstractInnerValve, Laws
from sysid.models.biviscous import Element
from sysid.models.biviscous_motion import biviscous_states
from sysid.models.current_table import read_table
from sysid.motion.motion import Motion
from sysid.parameters import param, places

Column: TypeAlias = Float[Array, " table"]
Degrees: TypeAlias = Float[Array, "..."]

TABLE_1: Final[dict[str, float]] = {
    "C_pre": 1.0e5, "m_l": 2.0, "tau": 0.003, "k.intercept": 1.5e6, "k.slope": 1.5e5,
    "C_post[0 A].intercept": 1400.0, "C_post[0 A].slope": -6.78,
    "C_post[0.2 A].intercept": 1265.0, "C_post[0.2 A].slope": -7.07,
    "C_post[0.4 A].intercept": 1451.0, "C_post[0.4 A].slope": -8.11,
    "C_post[0.6 A].intercept": 1616.0, "C_post[0.6 A].slope": -8.74,
    "C_post[0.8 A].intercept": 1734.0, "C_post[0.8 A].slope": -8.91,
    "C_post[1 A].intercept": 1824.0, "C_post[1 A].slope": -9.43,
    "F_y[0 A].intercept": 41.0, "F_y[0 A].slope": 0.19,
    "F_y[0.2 A].intercept": 331.0, "F_y[0.2 A].slope": -0.53,
    "F_y[0.4 A].intercept": 766.0, "F_y[0.4 A].slope": -1.87,
    "F_y[0.6 A].intercept": 1178.0, "F_y[0.6 A].slope": -3.47,
    "F_y[0.8 A].intercept": 1481.0, "F_y[0.8 A].slope": -5.26,
    "F_y[1 A].intercept": 1667.0, "F_y[1 A].slope": -6.42,
}  # fmt: skip
"""BS09 Table 1 (k in kN/m, printed kN), and what the text says of C_pre, m_l and the lag."""
CURRENTS: Final = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
"""A, of the paper's table."""

_SLOWEST_YIELD: Final = 0.9
"""Largest C_post, in parts of C_pre; with more there would be no yield."""
_LEAST_VISCOSITY, _LEAST_YIELD, _LEAST_STIFFNESS = 1e-3, 1e-6, 1e4
"""N·s/m, N, N/m: where lines in temperature that are carried too far would pass through zero.

No damper's fluid is softer than 10 kN/m, and C_pre/k would cost digits.
"""


class Warmth(NamedTuple):
    """Temperatures, °C, at which each law is read.

    Attributes:
        post: Of C_post.
        yielding: Of F_y.
        stiffness: Of k.
    """

    post: Degrees
    yielding: Degrees
    stiffness: Degrees


class Lumped(AbstractInnerValve):
    r"""A bi-viscous element and a mass in series with a spring, all of them warm.

        F = k (x − y),    m_l ÿ = k (x − y) − χ(ẏ)
        χ(v) = C_pre v for |v| ≤ v_y, else F_y sgn v + C_post v,    v_y = F_y / (C_pre − C_post)
        C_post, F_y and k = intercept + slope T
        τ di_eff/dt = i − i_eff

    C_post and F_y have such a line at each of some `currents`; between them, and beyond the last,
    both are straight in current.  So at every temperature they rise and fall with current just
    where the table does: the paper's C_post falls to 0.2 A and rises from there.  T is in °C,
    40 °C where it is not known.  Where temperature or current change during a test, the element
    has in each step the mean of its values at both ends.

    Motion between two points is the cubic through both displacements with both velocities; on it
    the equation is solved exactly (`biviscous`).  Steady loops are those of the periodic orbit
    (`biviscous_orbit`); any other motion starts from rest with a relaxed spring.

    Attributes:
        currents: A, of the table.

    Source:
        C. K. Batterbee, N. D. Sims, Temperature sensitive controller performance of MR dampers,
        J. Intell. Mater. Syst. Struct. 20 (2009), Fig. 4 and Table 1.  The paper does not say
        where the force is taken; this is the piston's side.
    """

    laws: ClassVar[Laws] = Laws(
        width=("k_intercept", "k_slope"),
        growth=("C_post_intercept", "C_post_slope"),
        yielding=("F_y_intercept", "F_y_slope"),
    )

    thermal: ClassVar[bool] = True

    currents: tuple[float, ...] = places()
    C_pre: Scalar = param(
        symbol="C_pre", name="pre-yield viscosity", unit="N·s/m",
        low=1.0, scale="log", typical=1.0e5,
    )  # fmt: skip
    m_l: Scalar = param(
        symbol="m_l", name="mass of the fluid", unit="kg", low=1e-3, scale="log", typical=2.0
    )
    tau: Scalar = param(
        symbol="tau", name="time constant of current and fluid", unit="s", low=0.0, typical=0.003
    )
    k_intercept: Scalar = param(
        symbol="k.intercept", name="stiffness at 0 °C", unit="N/m", typical=1.5e6
    )
    k_slope: Scalar = param(
        symbol="k.slope", name="change of stiffness per kelvin", unit="N/m/K", typical=1.5e5
    )
    C_post_intercept: Column = param(
        symbol="C_post[{} A].intercept", name="post-yield viscosity at {} A, 0 °C", unit="N·s/m",
        typical=1500.0, at="currents",
    )  # fmt: skip
    C_post_slope: Column = param(
        symbol="C_post[{} A].slope", name="its change per kelvin at {} A", unit="N·s/m/K",
        typical=8.0, at="currents",
    )  # fmt: skip
    F_y_intercept: Column = param(
        symbol="F_y[{} A].intercept", name="yield force at {} A, 0 °C", unit="N",
        typical=1000.0, at="currents",
    )  # fmt: skip
    F_y_slope: Column = param(
        symbol="F_y[{} A].slope", name="its change per kelvin at {} A", unit="N/K",
        typical=3.0, at="currents",
    )  # fmt: skip

    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """Damping force, N, positive when it resists compression."""
        return element_force(self.element(motion), motion)

    def parts(self, motion: Motion) -> Parts:
        """Yield part (C_pre − C_post) clip(ẏ, −v_y, v_y), viscous part C_post ẏ + m_l ÿ."""
        return _parts(self.element(motion), motion)

    def parts_changed(self, motion: Motion, changes: Changes) -> Parts:
        """The parts with factors on F_y, C_post and k, leaks beside the spring and one before it.

        Only what yields and flows belongs to the fluid: C_pre and m_l stay.  With the compliance s
        of a further spring, 1/k' = 1/k + s.
        """
        return _parts(self.changed_element(self.element(motion), changes), motion)

    def changed_element(self, element: Element, changes: Changes) -> Element:
        """An element's numbers with changes, as `parts_changed` has them."""
        stiffness = element.stiffness * changes.stiffness
        if changes.compliance is not None:
            stiffness = stiffness / (1.0 + changes.compliance * stiffness)
        return element._replace(
            stiffness=stiffness,
            post=jnp.clip(
                element.post * changes.viscous, _LEAST_VISCOSITY, _SLOWEST_YIELD * self.C_pre
            ),
            yielding=jnp.maximum(element.yielding * changes.yielding, _LEAST_YIELD),
            leakage=None if changes.leakage is None else jnp.asarray(changes.leakage),
        )

    def element(self, motion: Motion, warped: Callable[[Degrees], Warmth] | None = None) -> Element:
        """The element's numbers at every point, [..., n] or [..., 1] where they are constant.

        Args:
            motion: Current and temperature.
            warped: °C → the °C at which the lines of C_post, F_y and k are read, if others.
        """
        current = motion.current
        if current.shape[-1] > 1:
            current = lagged(current, motion, self.tau)
        warm = REFERENCE + excess_temperature(motion)
        at = Warmth(warm, warm, warm) if warped is None else warped(warm)

        def law(intercept: Column, slope: Column, warm: Degrees) -> Float[Array, "..."]:
            at_zero, per_kelvin = (
                read_table(current, self.currents, z) for z in (intercept, slope)
            )
            return at_zero + per_kelvin * warm

        post = law(self.C_post_intercept, self.C_post_slope, at.post)
        yielding = law(self.F_y_intercept, self.F_y_slope, at.yielding)
        return Element(
            stiffness=jnp.maximum(self.k_intercept + self.k_slope * at.stiffness, _LEAST_STIFFNESS),
            mass=self.m_l,
            pre=self.C_pre,
            post=jnp.clip(post, _LEAST_VISCOSITY, _SLOWEST_YIELD * self.C_pre),
            yielding=jnp.maximum(yielding, _LEAST_YIELD),
        )


def _parts(element: Element, motion: Motion) -> Parts:
    state = biviscous_states(element, motion)
    limit = element.yield_velocity
    yielding = (element.pre - element.post) * jnp.clip(state.w, -limit, limit)
    return Parts(yielding=yielding, viscous=element.stiffness * state.u - yielding)


def element_force(element: Element, motion: Motion) -> Float[Array, "*batch n"]:
    """Force of an element with given numbers on a motion, N."""
    return element.stiffness * biviscous_states(element, motion).u
