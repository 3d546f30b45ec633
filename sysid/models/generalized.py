"""The generalised hysteretic force–velocity model of W11, 16 parameters."""

from typing import ClassVar, Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.effects.base import Parts
from sysid.models.base import AbstractValve, Laws, parts_by_current
from sysid.motion.motion import Motion
from sysid.parameters import param


class Generalized(AbstractValve):
    r"""Hyperbolic-tangent hysteresis with laws in peak velocity and current.

    With v_m the peak velocity and i the current,

        F = C_i (F_t tanh(a (v + v_h + v_b) / 2) − F_b) (1 + k_v |v|)            (3)
        F_t = F_0 (1 + e^{a_1 v_m})                                               (4)
        C_i = 1 + k_2 [σ(a_2 (i + I_0)) − σ(a_2 I_0)], at least 1                 (5)
        a = a_0 / (1 + k_0 v_m)                                                   (6)
        v_h = sgn(ẍ) k_4 v_m (1 + k_3 [σ(a_3 (i + I_1)) − σ(a_3 I_1)])            (7)
        F_b = k_5 C_i F_t,  v_b = k_6 v_m                                         (8)
        k_v = k_1c e^{−a_4 v_m} for v ≥ 0, k_1e e^{−a_4 v_m} for v < 0            (9)

    where σ is the logistic function.

    Source:
        W11 Eqs. 3–10. Misprints as read in this project: Eq. 3 has k_ve below zero velocity and
        (1−e^−z)/(1+e^−z) is tanh(z/2); Eq. 8 has C_i inside F_b, so C_i² in total; Table 3's
        first k_1e is k_1c; v_m is Aω on loops; C_i is clipped at 1.
    """

    memoryless: ClassVar[bool] = True
    laws: ClassVar[Laws] = Laws(("k_4",), ("a_0",), ("k_1c", "k_1e"))

    F_0: Scalar = param(
        symbol="F_0", name="seal friction scale, half the force at rest", unit="N",
        low=0.0, scale="log", typical=70.0,
    )  # fmt: skip
    I_0: Scalar = param(
        symbol="I_0", name="current offset of the force gain", unit="A", typical=0.1
    )
    I_1: Scalar = param(
        symbol="I_1", name="current offset of the loop width", unit="A", typical=0.3
    )
    a_0: Scalar = param(
        symbol="a_0",
        name="low-velocity steepness",
        unit="s/m",
        low=0.0,
        scale="log",
        typical=1000.0,
    )
    a_1: Scalar = param(
        symbol="a_1", name="rise of transition force with speed", unit="s/m", low=0.0, typical=5.0
    )
    a_2: Scalar = param(
        symbol="a_2",
        name="steepness of the force gain in current",
        unit="1/A",
        low=0.0,
        typical=8.0,
    )
    a_3: Scalar = param(
        symbol="a_3",
        name="steepness of the loop width in current",
        unit="1/A",
        low=0.0,
        typical=7.0,
    )
    a_4: Scalar = param(
        symbol="a_4", name="decay of the high-velocity rise", unit="s/m", low=0.0, typical=6.0
    )
    k_0: Scalar = param(
        symbol="k_0", name="softening of the steepness with speed", unit="s/m",
        low=0.0, scale="log", typical=150.0,
    )  # fmt: skip
    k_1c: Scalar = param(
        symbol="k_1c", name="high-velocity rise in compression", unit="s/m", low=0.0, typical=10.0
    )
    k_1e: Scalar = param(
        symbol="k_1e", name="high-velocity rise in rebound", unit="s/m", low=0.0, typical=10.0
    )
    k_2: Scalar = param(symbol="k_2", name="size of the force gain", unit="-", low=0.0, typical=8.0)
    k_3: Scalar = param(
        symbol="k_3", name="growth of the loop width with current", unit="-", low=0.0, typical=10.0
    )
    k_4: Scalar = param(
        symbol="k_4", name="loop width per peak velocity at 0 A", unit="-", typical=0.1
    )
    k_5: Scalar = param(
        symbol="k_5", name="force offset per transition force", unit="-", low=0.0, typical=0.2
    )
    k_6: Scalar = param(
        symbol="k_6", name="velocity offset per peak velocity", unit="-", low=0.0, typical=0.3
    )

    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """Damping force, N, positive when it resists compression (Eq. 3)."""
        v, v_m, i = motion.velocity, motion.peak_velocity, motion.current
        C_i = self.force_gain(i)
        F_t = self.transition_force(v_m)
        a = self.steepness(v_m)
        v_h = motion.acceleration_sign * self.loop_half_width(v_m, i)
        v_b = self.k_6 * v_m
        F_b = self.k_5 * C_i * F_t
        k_1 = jnp.where(v >= 0.0, self.k_1c, self.k_1e)
        k_v = k_1 * jnp.exp(-self.a_4 * v_m)
        return C_i * (F_t * jnp.tanh(0.5 * a * (v + v_h + v_b)) - F_b) * (1.0 + k_v * jnp.abs(v))

    def parts(self, motion: Motion) -> Parts:
        """Yield part F(i) − F(0 A), viscous part F(0 A)."""
        return parts_by_current(self, motion)

    def transition_force(self, v_m: Float[Array, "..."]) -> Float[Array, "..."]:
        """F_t, N (Eq. 4)."""
        return self.F_0 * (1.0 + jnp.exp(self.a_1 * v_m))

    def force_gain(self, i: Float[Array, "..."]) -> Float[Array, "..."]:
        """C_i, a pure number, at least 1 (Eq. 5)."""
        return jnp.maximum(1.0, 1.0 + self.k_2 * logistic_rise(self.a_2 * i, self.a_2 * self.I_0))

    def steepness(self, v_m: Float[Array, "..."]) -> Float[Array, "..."]:
        """Steepness a of the tangent, s/m (Eq. 6)."""
        return self.a_0 / (1.0 + self.k_0 * v_m)

    def loop_half_width(
        self, v_m: Float[Array, "..."], i: Float[Array, "..."]
    ) -> Float[Array, "..."]:
        """|v_h| with the sign of k_4, m/s (Eq. 7 without sgn ẍ)."""
        rise = logistic_rise(self.a_3 * i, self.a_3 * self.I_1)
        return self.k_4 * v_m * (1.0 + self.k_3 * rise)


def logistic_rise(b: Float[Array, "..."], c: Float[Array, "..."]) -> Float[Array, "..."]:
    r"""σ(b + c) − σ(c), every digit kept where the two are nearly equal.

        σ(b + c) − σ(c) = σ(c) σ(−c) (1 − e^{−b}) / (σ(c) + σ(−c) e^{−b})

    Args:
        b: Increment, [...].
        c: Start, [...].

    Returns:
        [...], between −1 and 1.
    """
    start, rest = jax.nn.sigmoid(c), jax.nn.sigmoid(-c)
    return start * rest * -jnp.expm1(-b) / (start + rest * jnp.exp(-b))


LOW_SYMMETRIC: Final = {
    "F_0": 68.506, "I_0": 0.079, "I_1": 0.267, "a_0": 992.985,
    "a_1": 5.197, "a_2": 7.258, "a_3": 6.635, "a_4": 7.504,
    "k_0": 125.987, "k_1c": 11.2, "k_1e": 11.2, "k_2": 9.244,
    "k_3": 9.186, "k_4": -0.119, "k_5": 0.0, "k_6": 0.0,
}  # fmt: skip
"""W11 Table 2, 0.5–5 Hz (the 12.5 mm tests); trust it up to v_m = 0.393 m/s."""

HIGH_SYMMETRIC: Final = {
    "F_0": 70.921, "I_0": -0.082, "I_1": 0.165, "a_0": 988.967,
    "a_1": 4.477, "a_2": 12.757, "a_3": 10.137, "a_4": 5.501,
    "k_0": 177.249, "k_1c": 9.486, "k_1e": 9.486, "k_2": 4.355,
    "k_3": 17.781, "k_4": -0.156, "k_5": 0.0, "k_6": 0.0,
}  # fmt: skip
"""W11 Table 2, 5–15 Hz (the 2.5 mm tests); trust it up to v_m = 0.236 m/s."""

ASYMMETRIC: Final = {
    "F_0": 79.92, "I_0": 0.268, "I_1": 1.131, "a_0": 995.499,
    "a_1": 1.417, "a_2": 5.225, "a_3": 2.441, "a_4": 2.383,
    "k_0": 177.51, "k_1c": 16.877, "k_1e": 4.673, "k_2": 10.61,
    "k_3": 10.666, "k_4": -0.125, "k_5": 0.269, "k_6": 0.453,
}  # fmt: skip
"""W11 Table 3 (0.5 and 1.5 Hz at 12.5 and 25 mm, 0–0.3 A); trust it up to v_m = 0.236 m/s."""
