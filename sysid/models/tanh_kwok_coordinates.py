"""Solver coordinates of the hyperbolic-tangent model."""

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
from sysid.models.tanh_kwok import TanhKwok

TANH_VARIANTS: Final = ("full",)


class TanhKwokCoordinates(AllFreeCoordinates[TanhKwok]):
    r"""Value-type coordinates of the hyperbolic-tangent model.

    With N, V, I, L the campaign's reference force, speed, current and length, the ten are

        0  log c_a V/N     1  c_b s(I) V/N (softplus)
        2  log α_a/N       3  α_b s(I)/N (softplus)     4  qI (within ±15)
        5  log βV          6  kL/N                      7  f_0/N
        8  δ at 0 A        9  δ at I
    """

    kind: ClassVar[type[eqx.Module]] = TanhKwok

    @property
    def confined(self) -> tuple[tuple[str, str], ...]:
        """The bend of the laws in current."""
        return bend_confined(self.reference.current)

    def valve(self, u: Float[Array, " n"]) -> TanhKwok:
        """The model at u."""
        N, V, L = self.reference.force, self.reference.speed, self.reference.length
        q, effective = bend_at(u[4], self.reference.current)
        c_a, c_b = law_at(u[0:2], N / V, effective)
        alpha_a, alpha_b = law_at(u[2:4], N, effective)
        return TanhKwok(
            c_a=c_a, c_b=c_b, k=u[6] * N / L, alpha_a=alpha_a, alpha_b=alpha_b,
            beta=jnp.exp(u[5]) / V, delta_a=u[8], delta_b=(u[9] - u[8]) / effective,
            f_0=u[7] * N, q=q,
        )  # fmt: skip

    def locate(self, valve: TanhKwok) -> Float[Array, " n"]:
        """Coordinates of a model; values of zero are moved just inside."""
        N, V, L = self.reference.force, self.reference.speed, self.reference.length
        m = valve
        bend, effective = bend_place(m.q, self.reference.current)
        return jnp.stack([
            *law_place(m.c_a, m.c_b, N / V, effective),
            *law_place(m.alpha_a, m.alpha_b, N, effective),
            bend,
            jnp.log(m.beta * V),
            m.k * L / N,
            m.f_0 / N,
            m.delta_a,
            m.delta_a + m.delta_b * effective,
        ])  # fmt: skip
