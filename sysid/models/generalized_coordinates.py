"""Solver coordinates of the generalised model and of its variants."""

from typing import Final, Literal, get_args

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.models.coordinates import (
    AbstractCoordinates,
    Reference,
    positive,
    unfraction,
    unpositive,
)
from sysid.models.generalized import Generalized, logistic_rise
from sysid.parameters import specs

Variant = Literal["asymmetric", "symmetric", "passive", "mean"]
VARIANTS: Final[tuple[Variant, ...]] = get_args(Variant)

# Positions in the vector of all sixteen coordinates.
_SYMMETRIC: Final = tuple(range(13))
_PASSIVE: Final = (0, 1, 5, 6, 7, 11, 12)
_MEAN: Final = (0, 1, 2, 3, 4, 5, 6, 11, 12)
_FREE: Final[dict[str, tuple[int, ...]]] = {
    "asymmetric": tuple(range(16)),
    "symmetric": _SYMMETRIC,
    "passive": _PASSIVE,
    "mean": _MEAN,
}


_HELD: Final[dict[str, tuple[str, ...]]] = {
    "asymmetric": (),
    "symmetric": ("k_1e", "k_5", "k_6"),
    "passive": ("k_1e", "k_5", "k_6", "k_2", "k_3", "a_2", "a_3", "I_0", "I_1"),
    "mean": ("k_1e", "k_5", "k_6", "k_3", "a_3", "I_1", "k_4"),
}

_LIMIT: Final = 15.0
"""Beyond |a_2 I_0| = 15 the current law is an exponential to seven digits: nothing changes."""


def _limited(u: Float[Array, "..."]) -> Float[Array, "..."]:
    return _LIMIT * jnp.tanh(u / _LIMIT)


def _unlimited(c: Float[Array, "..."]) -> Float[Array, "..."]:
    return _LIMIT * jnp.arctanh(jnp.clip(c / _LIMIT, -0.999, 0.999))


class GeneralizedCoordinates(AbstractCoordinates[Generalized]):
    r"""Value-type coordinates of the generalised model.

    With V, I, N the campaign's reference speed, current and force, the sixteen are

        0  log F_t(V/2)/N           1  a_1 V (softplus)
        2  C_i(I) − 1 (softplus)    3  a_2 I (softplus)      4  a_2 I_0 (within ±15)
        5  log (1/a_0)/V            6  log k_0/a_0
        7  width w = k_4 (1 + k_3 …) at I, in units of 0.1
        8  width at 0 A / width at I (logistic)
        9  a_3 I (softplus)        10  a_3 I_1 (within ±15)
        11 log k_1c e^{−a_4 V/2} V 12  a_4 V (softplus)
        13 log k_1e e^{−a_4 V/2} V 14  k_5 (softplus)       15  k_6 (softplus)

    The parameter pairs that run off together in the paper's symbols (a_0 with k_0, k_2 with I_0,
    k_3 with I_1) leave here one coordinate that the data determine and one that they do not.

    Attributes:
        reference: The campaign's magnitudes.
        variant: "asymmetric" (16), "symmetric" (13: k_5 = k_6 = 0, k_1e = k_1c), "passive" (7:
            symmetric without current) or "mean" (9: symmetric without hysteresis, k_4 = 0).
    """

    reference: Reference
    variant: Variant = eqx.field(static=True)

    @property
    def size(self) -> int:
        """How many coordinates are free."""
        return len(_FREE[self.variant])

    @property
    def free(self) -> tuple[str, ...]:
        """Symbols of the free parameters."""
        held = _HELD[self.variant]
        return tuple(s.symbol for s in specs(Generalized) if s.symbol not in held)

    @property
    def ties(self) -> tuple[tuple[str, str], ...]:
        """k_1e follows k_1c in the symmetric variants."""
        return () if self.variant == "asymmetric" else (("k_1e", "k_1c"),)

    @property
    def confined(self) -> tuple[tuple[str, str], ...]:
        """The current offsets, where they are free."""
        products = (("I_0", "a_2 I_0"), ("I_1", "a_3 I_1"))
        return tuple((s, f"{z} within ± {_LIMIT:g}") for s, z in products if s in self.free)

    def valve(self, u: Float[Array, " n"]) -> Generalized:
        """The model at u."""
        full = jnp.zeros(16).at[np.array(_FREE[self.variant])].set(u)
        V, current = self.reference.speed, self.reference.current
        a_1, a_4 = positive(full[1]) / V, positive(full[12]) / V
        F_0 = self.reference.force * jnp.exp(full[0]) / (1.0 + jnp.exp(a_1 * V / 2))
        b_2, b_3 = positive(full[3]), positive(full[9])
        c_2, c_3 = _limited(full[4]), _limited(full[10])
        a_2, I_0 = b_2 / current, c_2 / b_2 * current
        a_3, I_1 = b_3 / current, c_3 / b_3 * current
        k_2 = positive(full[2]) / logistic_rise(b_2, c_2)
        width, fraction = 0.1 * full[7], jax.nn.sigmoid(full[8])
        k_3 = jnp.exp(-full[8]) / logistic_rise(b_3, c_3)
        unit = jnp.exp(a_4 * V / 2) / V
        k_1c, k_1e = jnp.exp(full[11]) * unit, jnp.exp(full[13]) * unit
        p, q = jnp.exp(full[5]) * V, jnp.exp(full[6])
        zero = jnp.zeros(())
        if self.variant != "asymmetric":
            k_1e, k_5, k_6 = k_1c, zero, zero
        else:
            k_5, k_6 = positive(full[14]), positive(full[15])
        if self.variant == "passive":
            k_2 = a_2 = I_0 = k_3 = a_3 = I_1 = zero
            fraction = jnp.ones(())
        if self.variant == "mean":
            width = k_3 = a_3 = I_1 = zero
        return Generalized(
            F_0=F_0, I_0=I_0, I_1=I_1, a_0=1.0 / p, a_1=a_1, a_2=a_2, a_3=a_3, a_4=a_4,
            k_0=q / p, k_1c=k_1c, k_1e=k_1e, k_2=k_2, k_3=k_3, k_4=width * fraction,
            k_5=k_5, k_6=k_6,
        )  # fmt: skip

    def locate(self, valve: Generalized) -> Float[Array, " n"]:
        """Coordinates of a model; rates and gains of zero are moved just inside."""
        V, current, m = self.reference.speed, self.reference.current, valve
        b_2 = jnp.maximum(m.a_2 * current, 1e-4)
        b_3 = jnp.maximum(m.a_3 * current, 1e-4)
        c_2, c_3 = b_2 * m.I_0 / current, b_3 * m.I_1 / current
        rise = m.k_3 * logistic_rise(b_3, c_3)
        tiny = 1e-12
        unit = V * jnp.exp(-m.a_4 * V / 2)
        full = jnp.stack([
            jnp.log(m.F_0 * (1.0 + jnp.exp(m.a_1 * V / 2)) / self.reference.force),
            unpositive(m.a_1 * V),
            unpositive(m.k_2 * logistic_rise(b_2, c_2)),
            unpositive(b_2),
            _unlimited(c_2),
            jnp.log(jnp.maximum(1.0 / m.a_0, tiny * V) / V),
            jnp.log(jnp.maximum(m.k_0 / m.a_0, tiny)),
            10.0 * m.k_4 * (1.0 + rise),
            unfraction(1.0 / (1.0 + rise)),
            unpositive(b_3),
            _unlimited(c_3),
            jnp.log(jnp.maximum(m.k_1c * unit, 1e-4)),
            unpositive(m.a_4 * V),
            jnp.log(jnp.maximum(m.k_1e * unit, 1e-4)),
            unpositive(m.k_5),
            unpositive(m.k_6),
        ])  # fmt: skip
        return full[np.array(_FREE[self.variant])]
