"""Solver coordinates of the Dahl model."""

from typing import ClassVar, Final

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.models.coordinates import AllFreeCoordinates
from sysid.models.current_law_coordinates import (
    bend_at,
    bend_confined,
    bend_place,
    law_at,
    law_place,
)
from sysid.models.dahl import Dahl

DAHL_VARIANTS: Final = ("full",)


class DahlCoordinates(AllFreeCoordinates[Dahl]):
    r"""Value-type coordinates of the Dahl model.

    With N, V, I, L the campaign's reference force, speed, current and length, the eight are

        0  log c_a V/N     1  c_b s(I) V/N (softplus)
        2  log α_a/N       3  α_b s(I)/N (softplus)     4  qI (within ±15)
        5  log ρL          6  k_0 L/N                   7  f_0/N
    """

    kind: ClassVar[type[eqx.Module]] = Dahl

    @property
    def confined(self) -> tuple[tuple[str, str], ...]:
        """The bend of the laws in current."""
        return bend_confined(self.reference.current)

    def valve(self, u: Float[Array, " n"]) -> Dahl:
        """The model at u."""
        N, L = self.reference.force, self.reference.length
        q, effective = bend_at(u[4], self.reference.current)
        c_a, c_b = law_at(u[0:2], N / self.reference.speed, effective)
        alpha_a, alpha_b = law_at(u[2:4], N, effective)
        return Dahl(
            c_a=c_a, c_b=c_b, k_0=u[6] * N / L, f_0=u[7] * N,
            alpha_a=alpha_a, alpha_b=alpha_b, q=q, rho=jnp.exp(u[5]) / L,
        )  # fmt: skip

    def locate(self, valve: Dahl) -> Float[Array, " n"]:
        """Coordinates of a model; values of zero are moved just inside."""
        N, L, m = self.reference.force, self.reference.length, valve
        bend, effective = bend_place(m.q, self.reference.current)
        return jnp.stack([
            *law_place(m.c_a, m.c_b, N / self.reference.speed, effective),
            *law_place(m.alpha_a, m.alpha_b, N, effective),
            bend,
            jnp.log(m.rho * L),
            m.k_0 * L / N,
            m.f_0 / N,
        ])  # fmt: skip
