"""The temperature-dependent lumped model of Batterbee and Sims (2009)."""

from typing import Final

import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.effects.base import Parts
from sysid.effects.causal import lagged
from sysid.effects.reference_temperature import REFERENCE, excess_temperature
from sysid.models.base import AbstractValve
from sysid.models.biviscous import Element, State
from sysid.models.biviscous_motion import biviscous_states
from sysid.models.current_table import read_table
from sysid.motion.motion import Motion
from sysid.parameters import param

CURRENTS: Final = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
"""A, of the table."""

TABLE_1: Final[dict[str, float]] = {
    "C_pre": 1.0e5, "m_l": 2.0, "k_0": 1.5e6, "k_T": 1.5e5, "tau": 0.003,
    "C_post_0": 1400.0, "C_post_1": 1265.0, "C_post_2": 1451.0,
    "C_post_3": 1616.0, "C_post_4": 1734.0, "C_post_5": 1824.0,
    "C_post_0T": -6.78, "C_post_1T": -7.07, "C_post_2T": -8.11,
    "C_post_3T": -8.74, "C_post_4T": -8.91, "C_post_5T": -9.43,
    "F_y_0": 41.0, "F_y_1": 331.0, "F_y_2": 766.0,
    "F_y_3": 1178.0, "F_y_4": 1481.0, "F_y_5": 1667.0,
    "F_y_0T": 0.19, "F_y_1T": -0.53, "F_y_2T": -1.87,
    "F_y_3T": -3.47, "F_y_4T": -5.26, "F_y_5T": -6.42,
}  # fmt: skip
"""BS09 Table 1 (k in kN/m, printed kN), and what the text says of C_pre, m_l and the lag."""

_SLOWEST_YIELD: Final = 0.9
"""Largest C_post, in parts of C_pre; with more there would be no yield."""
_LEAST_VISCOSITY, _LEAST_YIELD, _LEAST_STIFFNESS = 1e-3, 1e-6, 1e4
"""N·s/m, N, N/m: where lines in temperature that are carried too far would pass through zero.

No damper's fluid is softer than 10 kN/m, and C_pre/k would cost digits.
"""


class Lumped(AbstractValve):
    r"""A bi-viscous element and a mass in series with a spring, all of them warm.

        F = k (x − y),    m_l ÿ = k (x − y) − χ(ẏ)
        χ(v) = C_pre v for |v| ≤ v_y, else F_y sgn v + C_post v,    v_y = F_y / (C_pre − C_post)
        C_post = C_post_j + C_post_jT T,   F_y = F_y_j + F_y_jT T,   k = k_0 + k_T T
        τ di_eff/dt = i − i_eff

    j are the currents of the table (`CURRENTS`); between them, and beyond 1 A, both laws are
    straight in current.  So at every temperature they rise and fall with current just where the
    table does: C_post falls to 0.2 A and rises from there.  T is in °C, 40 °C where it is not
    known.  Where temperature or current change during a test, the element has in each step the
    mean of its values at both ends.

    Motion between two points is the cubic through both displacements with both velocities; on it
    the equation is solved exactly (`biviscous`).  Steady loops are those of the periodic orbit
    (`biviscous_orbit`); any other motion starts from rest with a relaxed spring.

    Source:
        C. K. Batterbee, N. D. Sims, Temperature sensitive controller performance of MR dampers,
        J. Intell. Mater. Syst. Struct. 20 (2009), Fig. 4 and Table 1.  The paper does not say
        where the force is taken; this is the piston's side.
    """

    C_pre: Scalar = param(
        symbol="C_pre", name="pre-yield viscosity", unit="N·s/m",
        low=1.0, scale="log", typical=1.0e5,
    )  # fmt: skip
    m_l: Scalar = param(
        symbol="m_l", name="mass of the fluid", unit="kg", low=1e-3, scale="log", typical=2.0
    )
    k_0: Scalar = param(
        symbol="k_0", name="stiffness at 0 °C", unit="N/m", low=0.0, scale="log", typical=1.5e6
    )
    k_T: Scalar = param(
        symbol="k_T", name="change of stiffness per kelvin", unit="N/m/K", typical=1.5e5
    )
    tau: Scalar = param(
        symbol="tau", name="time constant of current and fluid", unit="s", low=0.0, typical=0.003
    )
    C_post_0: Scalar = param(
        symbol="C_post_0", name="post-yield viscosity at 0 A, 0 °C", unit="N·s/m",
        low=0.0, scale="log", typical=1500.0,
    )  # fmt: skip
    C_post_1: Scalar = param(
        symbol="C_post_1", name="post-yield viscosity at 0.2 A, 0 °C", unit="N·s/m",
        low=0.0, scale="log", typical=1500.0,
    )  # fmt: skip
    C_post_2: Scalar = param(
        symbol="C_post_2", name="post-yield viscosity at 0.4 A, 0 °C", unit="N·s/m",
        low=0.0, scale="log", typical=1500.0,
    )  # fmt: skip
    C_post_3: Scalar = param(
        symbol="C_post_3", name="post-yield viscosity at 0.6 A, 0 °C", unit="N·s/m",
        low=0.0, scale="log", typical=1500.0,
    )  # fmt: skip
    C_post_4: Scalar = param(
        symbol="C_post_4", name="post-yield viscosity at 0.8 A, 0 °C", unit="N·s/m",
        low=0.0, scale="log", typical=1500.0,
    )  # fmt: skip
    C_post_5: Scalar = param(
        symbol="C_post_5", name="post-yield viscosity at 1 A, 0 °C", unit="N·s/m",
        low=0.0, scale="log", typical=1500.0,
    )  # fmt: skip
    C_post_0T: Scalar = param(
        symbol="C_post_0T", name="its change per kelvin at 0 A", unit="N·s/m/K", typical=8.0
    )
    C_post_1T: Scalar = param(
        symbol="C_post_1T", name="its change per kelvin at 0.2 A", unit="N·s/m/K", typical=8.0
    )
    C_post_2T: Scalar = param(
        symbol="C_post_2T", name="its change per kelvin at 0.4 A", unit="N·s/m/K", typical=8.0
    )
    C_post_3T: Scalar = param(
        symbol="C_post_3T", name="its change per kelvin at 0.6 A", unit="N·s/m/K", typical=8.0
    )
    C_post_4T: Scalar = param(
        symbol="C_post_4T", name="its change per kelvin at 0.8 A", unit="N·s/m/K", typical=8.0
    )
    C_post_5T: Scalar = param(
        symbol="C_post_5T", name="its change per kelvin at 1 A", unit="N·s/m/K", typical=8.0
    )
    F_y_0: Scalar = param(
        symbol="F_y_0", name="yield force at 0 A, 0 °C", unit="N",
        low=0.0, scale="log", typical=1000.0,
    )  # fmt: skip
    F_y_1: Scalar = param(
        symbol="F_y_1", name="yield force at 0.2 A, 0 °C", unit="N",
        low=0.0, scale="log", typical=1000.0,
    )  # fmt: skip
    F_y_2: Scalar = param(
        symbol="F_y_2", name="yield force at 0.4 A, 0 °C", unit="N",
        low=0.0, scale="log", typical=1000.0,
    )  # fmt: skip
    F_y_3: Scalar = param(
        symbol="F_y_3", name="yield force at 0.6 A, 0 °C", unit="N",
        low=0.0, scale="log", typical=1000.0,
    )  # fmt: skip
    F_y_4: Scalar = param(
        symbol="F_y_4", name="yield force at 0.8 A, 0 °C", unit="N",
        low=0.0, scale="log", typical=1000.0,
    )  # fmt: skip
    F_y_5: Scalar = param(
        symbol="F_y_5", name="yield force at 1 A, 0 °C", unit="N",
        low=0.0, scale="log", typical=1000.0,
    )  # fmt: skip
    F_y_0T: Scalar = param(
        symbol="F_y_0T", name="its change per kelvin at 0 A", unit="N/K", typical=3.0
    )
    F_y_1T: Scalar = param(
        symbol="F_y_1T", name="its change per kelvin at 0.2 A", unit="N/K", typical=3.0
    )
    F_y_2T: Scalar = param(
        symbol="F_y_2T", name="its change per kelvin at 0.4 A", unit="N/K", typical=3.0
    )
    F_y_3T: Scalar = param(
        symbol="F_y_3T", name="its change per kelvin at 0.6 A", unit="N/K", typical=3.0
    )
    F_y_4T: Scalar = param(
        symbol="F_y_4T", name="its change per kelvin at 0.8 A", unit="N/K", typical=3.0
    )
    F_y_5T: Scalar = param(
        symbol="F_y_5T", name="its change per kelvin at 1 A", unit="N/K", typical=3.0
    )

    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """Damping force, N, positive when it resists compression."""
        element, state = self._along(motion)
        return element.stiffness * state.u

    def parts(self, motion: Motion) -> Parts:
        """Yield part (C_pre − C_post) clip(ẏ, −v_y, v_y), viscous part C_post ẏ + m_l ÿ."""
        element, state = self._along(motion)
        yielding = (element.pre - element.post) * jnp.clip(
            state.w, -element.yield_velocity, element.yield_velocity
        )
        return Parts(yielding=yielding, viscous=element.stiffness * state.u - yielding)

    def element(self, motion: Motion) -> Element:
        """The element's numbers at every point, [..., n] or [..., 1] where they are constant."""
        current = motion.current
        if current.shape[-1] > 1:
            current = lagged(current, motion, self.tau)
        warm = REFERENCE + excess_temperature(motion)

        def law(name: str) -> Float[Array, "*batch c"]:
            rows = range(len(CURRENTS))
            at_zero = [getattr(self, f"{name}_{j}") for j in rows]
            per_kelvin = [getattr(self, f"{name}_{j}T") for j in rows]
            lines = (read_table(current, CURRENTS, z) for z in (at_zero, per_kelvin))
            intercept, slope = lines
            return intercept + slope * warm

        post = jnp.clip(law("C_post"), _LEAST_VISCOSITY, _SLOWEST_YIELD * self.C_pre)
        return Element(
            stiffness=jnp.maximum(self.k_0 + self.k_T * warm, _LEAST_STIFFNESS),
            mass=self.m_l,
            pre=self.C_pre,
            post=post,
            yielding=jnp.maximum(law("F_y"), _LEAST_YIELD),
        )

    def _along(self, motion: Motion) -> tuple[Element, State]:
        element = self.element(motion)
        return element, biviscous_states(element, motion)
