"""Solver coordinates of the Carreau–Yasuda model."""

from typing import ClassVar, Final

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.models.carreau import Carreau
from sysid.models.coordinates import AllFreeCoordinates
from sysid.models.current_law_coordinates import law_at, law_place
from sysid.models.field_law import field_share

CARREAU_VARIANTS: Final = ("full",)

_SATURATION: Final = 4.0
"""Beyond |log i_s/I| = 4 the law is a power or a step to two digits: nothing changes."""
_ORDER: Final = 1.5
"""m stays within e^{±1.5} = 0.22 … 4.5, which holds all laws of fields that are known."""
_SHARPNESS: Final = 2.0
"""n stays within e^{±2} = 0.14 … 7.4: a plateau never reached … a kink."""
_WIDTH: Final = 0.1
"""A loop's usual width in peak velocities."""


class CarreauCoordinates(AllFreeCoordinates[Carreau]):
    r"""Value-type coordinates of the Carreau–Yasuda model.

    With N, V, I, L the campaign's reference force, speed, current and length, the twelve are

        0  log c_a V/N     1  c_b g(I) V/N (softplus)
        2  log α_a/N       3  α_b g(I)/N (softplus)
        4  log i_s/I (within ±4)     5  log m (within ±1.5)
        6  log v_0/V       7  log n (within ±2)
        8  kL/N            9  f_0/N
        10  10 h/V at 0 A  11  10 h/V at I
    """

    kind: ClassVar[type[eqx.Module]] = Carreau

    @property
    def confined(self) -> tuple[tuple[str, str], ...]:
        """The orders of both laws, and where the one in current saturates."""
        ranges = (
            ("i_s", _SATURATION, float(self.reference.current), " A"),
            ("m", _ORDER, 1.0, ""),
            ("n", _SHARPNESS, 1.0, ""),
        )
        return tuple(
            (symbol, f"within {middle * np.exp(-z):.3g} … {middle * np.exp(z):.3g}{unit}")
            for symbol, z, middle, unit in ranges
        )

    def valve(self, u: Float[Array, " n"]) -> Carreau:
        """The model at u."""
        N, V, L = self.reference.force, self.reference.speed, self.reference.length
        i_s = jnp.exp(_within(u[4], _SATURATION)) * self.reference.current
        m = jnp.exp(_within(u[5], _ORDER))
        full = field_share(self.reference.current, i_s, m)
        c_a, c_b = law_at(u[0:2], N / V, full)
        alpha_a, alpha_b = law_at(u[2:4], N, full)
        width = _WIDTH * V
        return Carreau(
            c_a=c_a, c_b=c_b, k=u[8] * N / L, f_0=u[9] * N, alpha_a=alpha_a, alpha_b=alpha_b,
            i_s=i_s, m=m, v_0=jnp.exp(u[6]) * V, n=jnp.exp(_within(u[7], _SHARPNESS)),
            h_a=width * u[10], h_b=width * (u[11] - u[10]) / full,
        )  # fmt: skip

    def locate(self, valve: Carreau) -> Float[Array, " n"]:
        """Coordinates of a model; values of zero are moved just inside."""
        N, V, L = self.reference.force, self.reference.speed, self.reference.length
        p, width = valve, _WIDTH * V
        full = field_share(self.reference.current, p.i_s, p.m)
        return jnp.stack([
            *law_place(p.c_a, p.c_b, N / V, full),
            *law_place(p.alpha_a, p.alpha_b, N, full),
            _place(jnp.log(p.i_s / self.reference.current), _SATURATION),
            _place(jnp.log(p.m), _ORDER),
            jnp.log(p.v_0 / V),
            _place(jnp.log(p.n), _SHARPNESS),
            p.k * L / N,
            p.f_0 / N,
            p.h_a / width,
            (p.h_a + p.h_b * full) / width,
        ])  # fmt: skip


def _within(u: Scalar, limit: float) -> Scalar:
    """A number of either sign, kept inside ±limit."""
    return limit * jnp.tanh(u / limit)


def _place(y: Scalar, limit: float) -> Scalar:
    """The way back of `_within`."""
    return limit * jnp.arctanh(jnp.clip(y / limit, -0.999, 0.999))
