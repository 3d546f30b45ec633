"""A yield stress that sets in gradually: the law of Carreau and Yasuda between the plates."""

from typing import ClassVar

import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.effects.base import Force, Parts
from sysid.models.base import AbstractValve, Laws
from sysid.models.field_law import field_share
from sysid.motion.motion import Motion
from sysid.parameters import param

_STANDSTILL = 1e-6
"""Parts of v_0 below which |v| is rounded off, so that its powers have derivatives."""


class Carreau(AbstractValve):
    r"""Bingham's law whose yield force sets in gradually, with a law in current of its own.

        F = c v + k x + f_0 + α φ(s),   φ(s) = s / (1 + |s|^n)^{1/n}
        s = (v − h sgn ẍ) / v_0
        c = c_a + c_b g(i),  α = α_a + α_b g(i),  h = h_a + h_b g(i),  g(i) = 1 − e^{−(|i|/i_s)^m}

    with x from the centre of the test and sgn ẍ that of the fundamental.  α/v_0 is the slope at
    standstill; n says how the plateau is reached: large, at once (Bingham); 2, as a root; below 1,
    over decades of speed, as gaps of unequal width and shear-thinning fluids do.  No plateau need
    be reached inside the tests.  The two exponents, n in speed and m in current, are what the
    tables over current and speed of other programs are used for.

    The yield part is α φ, the viscous part c v; k x + f_0 is the gas force.

    Source:
        K. Yasuda, R. C. Armstrong, R. E. Cohen, Shear flow properties of concentrated solutions of
        linear and star branched polystyrenes, Rheologica Acta 20 (1981), with power-law index 0
        and Bingham's viscosity c beside it; the shift h of the branches as in the models of Kwok
        et al. (2006) and W11 Eq. 7.
    """

    memoryless: ClassVar[bool] = True
    laws: ClassVar[Laws] = Laws(("h_a", "h_b"), ("v_0",), ("c_a", "c_b"))

    c_a: Scalar = param(
        symbol="c_a", name="viscosity at 0 A", unit="N·s/m", low=0.0, scale="log", typical=1000.0
    )
    c_b: Scalar = param(
        symbol="c_b", name="rise of viscosity to saturation", unit="N·s/m", low=0.0, typical=1000.0
    )
    k: Scalar = param(symbol="k", name="stiffness", unit="N/m", typical=1000.0)
    f_0: Scalar = param(symbol="f_0", name="force at the centre", unit="N", typical=50.0)
    alpha_a: Scalar = param(
        symbol="alpha_a", name="yield force at 0 A", unit="N", low=0.0, scale="log", typical=100.0
    )
    alpha_b: Scalar = param(
        symbol="alpha_b", name="rise of the yield force to saturation", unit="N", low=0.0,
        typical=1000.0,
    )  # fmt: skip
    i_s: Scalar = param(
        symbol="i_s", name="current of saturation", unit="A", low=0.0, scale="log", typical=1.0
    )
    m: Scalar = param(
        symbol="m", name="order of the law in current", unit="-", low=0.0, typical=1.5
    )
    v_0: Scalar = param(
        symbol="v_0", name="speed at which yielding sets in", unit="m/s", low=0.0, scale="log",
        typical=0.005,
    )  # fmt: skip
    n: Scalar = param(symbol="n", name="sharpness of yielding", unit="-", low=0.0, typical=1.0)
    h_a: Scalar = param(
        symbol="h_a", name="shift of the branches at 0 A", unit="m/s", typical=0.005
    )
    h_b: Scalar = param(
        symbol="h_b", name="rise of the shift to saturation", unit="m/s", typical=0.005
    )

    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """Damping force, N, positive when it resists compression."""
        return self.without_gas(motion) + self.gas_force(motion)

    def gas_force(self, motion: Motion) -> Force:
        """The gas spring's k x + f_0, N."""
        return self.k * motion.displacement + self.f_0

    def without_gas(self, motion: Motion) -> Force:
        """The oil's c v + α φ, N."""
        return self.parts(motion).total

    def parts(self, motion: Motion) -> Parts:
        """Yield part α φ, viscous part c v."""
        g, v = field_share(motion.current, self.i_s, self.m), motion.velocity
        s = (v - (self.h_a + self.h_b * g) * motion.acceleration_sign) / self.v_0
        size = jnp.sqrt(s * s + _STANDSTILL**2)
        # s below 1 and above are written so that no power overflows
        onset = jnp.where(
            size < 1.0,
            s * _root(jnp.minimum(size, 1.0) ** self.n, self.n),
            s / size * _root(jnp.maximum(size, 1.0) ** -self.n, self.n),
        )
        yielding = (self.alpha_a + self.alpha_b * g) * onset
        return Parts(yielding=yielding, viscous=(self.c_a + self.c_b * g) * v)


def _root(power: Float[Array, "..."], n: Scalar) -> Float[Array, "..."]:
    """(1 + power)^{−1/n}."""
    return jnp.exp(-jnp.log1p(power) / n)
