"""The simple Bouc–Wen model."""

from typing import ClassVar

from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.effects.base import Changes, Parts
from sysid.models.base import AbstractInnerValve, Laws, parts_by_current
from sysid.models.current_law import effective_current
from sysid.models.series_parts import ByCurrent, SeriesLaw, parts_in_series
from sysid.motion.motion import Motion
from sysid.parameters import param


class BoucWen(AbstractInnerValve):
    r"""Viscosity, a spring, and Bouc and Wen's hysteresis in its normalised form.

        F = c v + k_0 x + f_0 + α w
        ẇ = ρ (v − σ |v| w |w| − (1 − σ) v w²)
        c = c_a + c_b s(i),  α = α_a + α_b s(i),  s(i) = (1 − e^{−q|i|}) / q

    with x from the centre of the test.  The usual ż = −γ|v| z |z|^{n−1} − β v |z|^n + A v is the
    same with w = z/z_u, z_u = (A/(β+γ))^{1/n}, ρ = A/z_u, σ = γ/(β+γ) and α z_u for α: one of its
    four numbers can be chosen freely, so no data could determine them.  The exponent n is 2, as in
    the source.  σ ≥ 1/2 (γ ≥ β) makes the model dissipate.  Steady loops are those of the
    periodic state; any other motion starts at w = 0.

    Source:
        R. Bouc (1971); Y. K. Wen, J. Eng. Mech. Div. 102 (1976); B. F. Spencer, S. J. Dyke,
        M. K. Sain, J. D. Carlson, Phenomenological model for magnetorheological dampers, J. Eng.
        Mech. 123 (1997) Eqs. 4–5, k_0 x_0 = −f_0; normalised form: F. Ikhouane, V. Mañosa,
        J. Rodellar, Systems & Control Letters 56 (2007).  The source's laws are linear in
        voltage; those of `current_law` may bend.
    """

    laws: ClassVar[Laws] = Laws(width=("rho",), growth=("c_a", "c_b"))

    c_a: Scalar = param(
        symbol="c_a", name="viscosity at 0 A", unit="N·s/m", low=0.0, scale="log", typical=1000.0
    )
    c_b: Scalar = param(
        symbol="c_b", name="rise of viscosity", unit="N·s/m/A", low=0.0, typical=1000.0
    )
    k_0: Scalar = param(symbol="k_0", name="stiffness", unit="N/m", typical=1000.0)
    f_0: Scalar = param(symbol="f_0", name="force at the centre", unit="N", typical=50.0)
    alpha_a: Scalar = param(
        symbol="alpha_a", name="yield force at 0 A", unit="N", low=0.0, scale="log", typical=100.0
    )
    alpha_b: Scalar = param(
        symbol="alpha_b", name="rise of the yield force", unit="N/A", low=0.0, typical=1000.0
    )
    q: Scalar = param(symbol="q", name="bend of the laws in current", unit="1/A", typical=1.0)
    rho: Scalar = param(
        symbol="rho", name="rate of yielding with travel", unit="1/m",
        low=0.0, scale="log", typical=1000.0,
    )  # fmt: skip
    sigma: Scalar = param(
        symbol="sigma", name="share of dissipation in yielding", unit="-", low=0.5, typical=1.0
    )

    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """Damping force, N, positive when it resists compression."""
        return self.parts_changed(motion, Changes()).total

    def parts(self, motion: Motion) -> Parts:
        """Yield part F(i) − F(0 A), viscous part F(0 A)."""
        return parts_by_current(self, motion)

    def parts_changed(self, motion: Motion, changes: Changes) -> Parts:
        """The parts with changes, as `parts_in_series` has them."""
        return parts_in_series(self.series_law(motion.current), motion, changes)

    def series_law(self, current: Float[Array, "..."]) -> SeriesLaw:
        """What the valve is made of at a current, A."""
        s = effective_current(current, self.q)
        return SeriesLaw(
            yielding=ByCurrent(self.alpha_a, self.alpha_b * s),
            inner=ByCurrent(self.c_a, self.c_b * s),
            outer=None,
            stiffness=None,
            rho=self.rho,
            sigma=self.sigma,
            beside=self.k_0,
            constant=self.f_0,
        )
