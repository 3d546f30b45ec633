"""Solver coordinates of the modified Bouc–Wen model."""

from typing import ClassVar, Final

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.models.coordinates import AllFreeCoordinates, positive, unpositive
from sysid.models.current_law_coordinates import (
    bend_at,
    bend_confined,
    bend_place,
    law_at,
    law_place,
)
from sysid.models.modified_bouc_wen import ModifiedBoucWen

MODIFIED_BOUC_WEN_VARIANTS: Final = ("full",)

_SOFT: Final = 0.1
"""Ordinary c_0 in units of c_1."""
_SMALLEST: Final = 1e-4
"""Viscosities of zero are raised to this, in N/V."""
_STIFFNESS: Final = 0.1
"""Ordinary k_0 in units of N/L."""


class ModifiedBoucWenCoordinates(AllFreeCoordinates[ModifiedBoucWen]):
    r"""Value-type coordinates of the modified Bouc–Wen model.

    Seen from outside, the yielding element with the second dashpot has the viscosity
    c = c_0/(1 + r), r = c_0/c_1, the yield force α/(1 + r) and the stiffness k_0 + k_1: those are
    coordinates, and r and k_0 beside them, which show only after a reversal.  With N, V, I, L the
    campaign's reference force, speed, current and length, the twelve are

        0  log c_a V/N          1  c_b s(I) V/N (softplus)
        2  log α_a/(1 + r_a)N   3  α_b s(I)/(1 + r_b)N (softplus)   4  qI (within ±15)
        5  log ρL               6  (k_0 + k_1) L/N                  7  f_0/N
        8  2σ − 1 (softplus)    9  log 10 c_0a/c_1a                10  log 10 c_0b/c_1b
        11 10 k_0 L/N (softplus)
    """

    kind: ClassVar[type[eqx.Module]] = ModifiedBoucWen

    @property
    def confined(self) -> tuple[tuple[str, str], ...]:
        """The bend of the laws in current."""
        return bend_confined(self.reference.current)

    def valve(self, u: Float[Array, " n"]) -> ModifiedBoucWen:
        """The model at u."""
        N, V, L = self.reference.force, self.reference.speed, self.reference.length
        q, effective = bend_at(u[4], self.reference.current)
        c_a, c_b = law_at(u[0:2], N / V, effective)
        alpha_a, alpha_b = law_at(u[2:4], N, effective)
        r_a, r_b = _SOFT * jnp.exp(u[9]), _SOFT * jnp.exp(u[10])
        k_0 = positive(u[11]) * _STIFFNESS * N / L
        return ModifiedBoucWen(
            c_0a=c_a * (1.0 + r_a), c_0b=c_b * (1.0 + r_b),
            c_1a=c_a * (1.0 + 1.0 / r_a), c_1b=c_b * (1.0 + 1.0 / r_b),
            k_0=k_0, k_1=u[6] * N / L - k_0, f_0=u[7] * N,
            alpha_a=alpha_a * (1.0 + r_a), alpha_b=alpha_b * (1.0 + r_b), q=q,
            rho=jnp.exp(u[5]) / L, sigma=0.5 + 0.5 * positive(u[8]),
        )  # fmt: skip

    def locate(self, valve: ModifiedBoucWen) -> Float[Array, " n"]:
        """Coordinates of a model; values of zero are moved just inside."""
        N, V, L = self.reference.force, self.reference.speed, self.reference.length
        m = valve
        bend, effective = bend_place(m.q, self.reference.current)
        least = _SMALLEST * N / V
        c_0a, c_0b = jnp.maximum(m.c_0a, least), jnp.maximum(m.c_0b, least / effective)
        r_a = c_0a / jnp.maximum(m.c_1a, least)
        r_b = c_0b / jnp.maximum(m.c_1b, least / effective)
        return jnp.stack([
            *law_place(c_0a / (1.0 + r_a), c_0b / (1.0 + r_b), N / V, effective),
            *law_place(m.alpha_a / (1.0 + r_a), m.alpha_b / (1.0 + r_b), N, effective),
            bend,
            jnp.log(m.rho * L),
            (m.k_0 + m.k_1) * L / N,
            m.f_0 / N,
            unpositive(2.0 * m.sigma - 1.0),
            jnp.log(r_a / _SOFT),
            jnp.log(r_b / _SOFT),
            unpositive(m.k_0 * L / N / _STIFFNESS),
        ])  # fmt: skip
