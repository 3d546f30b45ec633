"""The modified Bouc–Wen model of Spencer et al. (1997)."""

from typing import ClassVar

from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.effects.base import Changes, Parts
from sysid.models.base import AbstractInnerValve, Laws, parts_by_current
from sysid.models.current_law import effective_current
from sysid.models.series_parts import ByCurrent, SeriesLaw, parts_in_series
from sysid.motion.motion import Motion
from sysid.parameters import param


class ModifiedBoucWen(AbstractInnerValve):
    r"""Bouc–Wen, a dashpot and a spring, all in series with a second dashpot.

        F = c_1 ẏ + k_1 x + f_0
        ẏ = [α w + c_0 ẋ + k_0 (x − y)] / (c_0 + c_1)
        ẇ = ρ ((ẋ−ẏ) − σ |ẋ−ẏ| w |w| − (1 − σ) (ẋ−ẏ) w²)
        α = α_a + α_b s(i),  c_0 = c_0a + c_0b s(i),  c_1 = c_1a + c_1b s(i)
        s(i) = (1 − e^{−q|i|}) / q

    with x from the centre of the test.  The second dashpot lets the force roll off near zero
    velocity where displacement and velocity have opposite signs, which the simple model cannot.
    f_0 stands for −k_1 x_0, w for the source's z/z_u as in `bouc_wen`, n = 2.  Steady loops are
    those of the periodic state; any other motion starts at w = 0 and x − y = 0 at its first point.

    Source:
        B. F. Spencer, S. J. Dyke, M. K. Sain, J. D. Carlson, Phenomenological model for
        magnetorheological dampers, J. Eng. Mech. 123 (1997) Eqs. 8–16, with current in place of
        the filtered voltage.  The source's laws are linear; those of `current_law` may bend.
    """

    laws: ClassVar[Laws] = Laws(width=("rho",), growth=("c_0a", "c_0b"))

    c_0a: Scalar = param(
        symbol="c_0a", name="viscosity at 0 A", unit="N·s/m", low=0.0, scale="log", typical=1000.0
    )
    c_0b: Scalar = param(
        symbol="c_0b", name="rise of viscosity", unit="N·s/m/A", low=0.0, typical=1000.0
    )
    c_1a: Scalar = param(
        symbol="c_1a", name="viscosity in series at 0 A", unit="N·s/m",
        low=0.0, scale="log", typical=10000.0,
    )  # fmt: skip
    c_1b: Scalar = param(
        symbol="c_1b", name="rise of the viscosity in series", unit="N·s/m/A",
        low=0.0, typical=10000.0,
    )  # fmt: skip
    k_0: Scalar = param(
        symbol="k_0", name="stiffness beside the valve", unit="N/m",
        low=0.0, scale="log", typical=1000.0,
    )  # fmt: skip
    k_1: Scalar = param(
        symbol="k_1", name="stiffness of the accumulator", unit="N/m", typical=500.0
    )
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
        """The parts of one state, with changes, as `parts_in_series` has them."""
        return parts_in_series(self.series_law(motion.current), motion, changes)

    def series_law(self, current: Float[Array, "..."]) -> SeriesLaw:
        """What the valve is made of at a current, A."""
        s = effective_current(current, self.q)
        return SeriesLaw(
            yielding=ByCurrent(self.alpha_a, self.alpha_b * s),
            inner=ByCurrent(self.c_0a, self.c_0b * s),
            outer=ByCurrent(self.c_1a, self.c_1b * s),
            stiffness=self.k_0,
            rho=self.rho,
            sigma=self.sigma,
            beside=self.k_1,
            constant=self.f_0,
        )
