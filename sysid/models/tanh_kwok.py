"""The hyperbolic-tangent model of Kwok et al. (2006)."""

from typing import ClassVar

import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.effects.base import Force, Parts
from sysid.models.base import AbstractValve, Laws, parts_by_current
from sysid.models.current_law import effective_current
from sysid.motion.motion import Motion
from sysid.parameters import param


class TanhKwok(AbstractValve):
    r"""Viscosity, stiffness and a hyperbolic tangent shifted by the side of the stroke.

        F = c v + k x + α tanh(β v + δ sgn x) + f_0
        c = c_a + c_b s(i),  α = α_a + α_b s(i),  δ = δ_a + δ_b s(i)
        s(i) = (1 − e^{−q|i|}) / q

    with x from the centre of the test, and sgn x the sign of the fundamental, so that harmonics of
    the actuator do not flip it.  There is no memory: width and slope of the loop at low speed are
    the same at every peak velocity.  k x + f_0 is the gas force.

    Source:
        N. M. Kwok, Q. P. Ha, T. H. Nguyen, J. Li, B. Samali, A novel hysteretic model for
        magnetorheological fluid dampers and parameter identification using particle swarm
        optimization, Sensors and Actuators A 132 (2006): the force.  The laws in current are
        those of `current_law`; the source fits every current by itself.
    """

    memoryless: ClassVar[bool] = True
    laws: ClassVar[Laws] = Laws(("delta_a", "delta_b"), ("beta",), ("c_a", "c_b"))

    c_a: Scalar = param(
        symbol="c_a", name="viscosity at 0 A", unit="N·s/m", low=0.0, scale="log", typical=1000.0
    )
    c_b: Scalar = param(
        symbol="c_b", name="rise of viscosity", unit="N·s/m/A", low=0.0, typical=1000.0
    )
    k: Scalar = param(symbol="k", name="stiffness", unit="N/m", typical=1000.0)
    alpha_a: Scalar = param(
        symbol="alpha_a", name="yield force at 0 A", unit="N", low=0.0, scale="log", typical=100.0
    )
    alpha_b: Scalar = param(
        symbol="alpha_b", name="rise of the yield force", unit="N/A", low=0.0, typical=1000.0
    )
    beta: Scalar = param(
        symbol="beta", name="steepness", unit="s/m", low=0.0, scale="log", typical=50.0
    )
    delta_a: Scalar = param(symbol="delta_a", name="shift at 0 A", unit="-", typical=0.5)
    delta_b: Scalar = param(symbol="delta_b", name="rise of the shift", unit="1/A", typical=0.5)
    f_0: Scalar = param(symbol="f_0", name="force at the centre", unit="N", typical=50.0)
    q: Scalar = param(symbol="q", name="bend of the laws in current", unit="1/A", typical=1.0)

    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """Damping force, N, positive when it resists compression."""
        return self.without_gas(motion) + self.gas_force(motion)

    def gas_force(self, motion: Motion) -> Force:
        """The gas spring's k x + f_0, N."""
        return self.k * motion.displacement + self.f_0

    def without_gas(self, motion: Motion) -> Force:
        """The oil's c v + α tanh(β v + δ sgn x), N."""
        s, v = effective_current(motion.current, self.q), motion.velocity
        shift = (self.delta_a + self.delta_b * s) * motion.acceleration_sign
        yielding = (self.alpha_a + self.alpha_b * s) * jnp.tanh(self.beta * v - shift)
        return (self.c_a + self.c_b * s) * v + yielding

    def parts(self, motion: Motion) -> Parts:
        """Yield part F(i) − F(0 A), viscous part F(0 A), of the force without gas."""
        return parts_by_current(self, motion)
