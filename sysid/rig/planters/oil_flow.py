"""Pressure drops of oil that flows beside or before the magnetic gap, on the piston."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.planter import Planter, Stage
from sysid.rig.planters.roots import rising_root

Values = Float[np.ndarray, "..."]


def slot_wall_stress(
    flow: Values, width: float, gap: float, consistency: float, index: float, yield_stress: float
) -> Values:
    """Wall stress of a Herschel–Bulkley fluid in a narrow annulus, [...] Pa.

    With the wall stress τ_w above the yield stress τ_0,

        Q = (w h² / 2) n/(n+1) K^(−1/n) (τ_w − τ_0)^(1+1/n) / τ_w · (1 − n/(2n+1) (1 − τ_0/τ_w))

    inverted on a grid of stresses and interpolated.

    Args:
        flow: Q, not negative, [...] m³/s.
        width: w, circumference of the annulus, m.
        gap: h, m.
        consistency: K, Pa·sⁿ.
        index: n.
        yield_stress: τ_0, Pa.

    Source:
        Bird, Stewart, Lightfoot, Transport Phenomena, slit flow; Chhabra and Richardson,
        Non-Newtonian Flow and Applied Rheology, ch. 3.
    """
    n = index
    largest = consistency * ((4.0 * n + 2.0) / n * np.max(flow) / (width * gap**2)) ** n
    above = np.concatenate([[0.0], np.geomspace(1e-9, 2.0, 4000)])
    above = above * (largest + yield_stress + 1e-30)
    wall = yield_stress + above
    with np.errstate(invalid="ignore"):
        plug = np.where(wall > 0.0, above / np.where(wall > 0.0, wall, 1.0), 1.0)
    table = (
        0.5 * width * gap**2 * n / (n + 1.0) * (above / consistency) ** (1.0 / n)
        * plug * (1.0 - n / (2.0 * n + 1.0) * plug)
    )  # fmt: skip
    return np.interp(flow, table, wall)


@dataclass(frozen=True, kw_only=True)
class ShearThinningGap(Planter):
    """A Herschel–Bulkley oil driven through an annulus: 2 L τ_w / h on the piston's area.

    Attributes:
        size: Consistency K, Pa·sⁿ.
        index: n.
        yield_stress: Of the carrier oil, Pa.
        length: L, m.
        gap: h, m.
        width: Circumference, m.
        piston_area: m².
    """

    name: ClassVar[str] = "shear_thinning_gap"
    causes: ClassVar[tuple[str, ...]] = ("shear_thinning",)
    family: ClassVar[str | None] = "viscous"
    stage: ClassVar[Stage] = "force"
    dissipates: ClassVar[bool] = True
    size: float = 1.5
    index: float = 0.65
    yield_stress: float = 0.0
    length: float = 0.02
    gap: float = 1.0e-3
    width: float = 0.11
    piston_area: float = 1.2e-3

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        if self.size == 0.0:
            return state
        flow = self.piston_area * np.abs(state.velocity)
        wall = slot_wall_stress(
            flow, self.width, self.gap, self.size, self.index, self.yield_stress
        )
        drop = 2.0 * self.length * wall / self.gap
        return state.adding(self.piston_area * drop * np.sign(state.velocity))


@dataclass(frozen=True, kw_only=True)
class Orifice(Planter):
    """A sharp-edged hole that all oil passes: ρ/2 (Q / (C_d A_o))².

    Attributes:
        size: Density of the oil times the square of the contraction 1/C_d, kg/m³.
        hole_area: m².
        piston_area: m².
    """

    name: ClassVar[str] = "orifice"
    causes: ClassVar[tuple[str, ...]] = ("quadratic_loss",)
    family: ClassVar[str | None] = "viscous"
    stage: ClassVar[Stage] = "force"
    dissipates: ClassVar[bool] = True
    size: float = 8000.0
    hole_area: float = 2.0e-4
    piston_area: float = 1.2e-3

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        jet = state.velocity * self.piston_area / self.hole_area
        return state.adding(0.5 * self.size * self.piston_area * jet * np.abs(jet))


@dataclass(frozen=True, kw_only=True)
class OilFilm(Planter):
    """A film of Newtonian oil sheared between piston and cylinder: η π D L v / h.

    Attributes:
        size: Viscosity, Pa·s.
        diameter: m.
        length: m.
        film: Thickness h, m.
    """

    name: ClassVar[str] = "oil_film"
    causes: ClassVar[tuple[str, ...]] = ("linear_viscosity",)
    family: ClassVar[str | None] = "viscous"
    stage: ClassVar[Stage] = "force"
    dissipates: ClassVar[bool] = True
    size: float = 0.4
    diameter: float = 0.04
    length: float = 0.06
    film: float = 1.0e-5

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        drag = self.size * np.pi * self.diameter * self.length / self.film
        return state.adding(drag * state.velocity)


@dataclass(frozen=True, kw_only=True)
class LeakingPiston(Planter):
    """A worn ring lets oil past the valve: v = u + F(u) k_l, k_l of a laminar slot.

    Attributes:
        size: Leaking speed of the piston per force, m/(s·N).
    """

    name: ClassVar[str] = "leaking_piston"
    causes: ClassVar[tuple[str, ...]] = ("bypass_leakage",)
    family: ClassVar[str | None] = "friction"
    stage: ClassVar[Stage] = "motion"
    size: float = 1.0e-6

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        if self.size == 0.0:
            return state
        v = state.valve_velocity
        reach = self.size * (np.abs(state.force) + 100.0) * 4.0 + 1e-9
        u = rising_root(
            lambda u: u + self.size * state.valve_force(velocity=u) - v, v - reach, v + reach
        )
        return state.with_valve(velocity=u)
