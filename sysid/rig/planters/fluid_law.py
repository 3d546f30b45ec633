"""How the fluid's viscosity and strength follow temperature and the rate of change."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.planter import Planter, Stage
from sysid.rig.planters.valve import Values, Valve


def vogel_ratio(temperature: Values, slope: float, reference: float = 40.0) -> Values:
    """Viscosity over that at the reference temperature (Vogel): e^(B/(T−T_v) − B/(T_0−T_v)).

    Args:
        temperature: [...] °C.
        slope: −d ln η/dT at the reference, 1/K; gives B.
        reference: T_0, °C.
    """
    freezing = -110.0
    b = slope * (reference - freezing) ** 2
    return np.exp(b / (temperature - freezing) - b / (reference - freezing))


@dataclass(frozen=True)
class ScaledFluid:
    """A valve whose fluid and field part have factors, one a test, [L, 1]."""

    inner: Valve
    fluid: Float[np.ndarray, "loop 1"]
    field: Float[np.ndarray, "loop 1"]

    @property
    def memoryless(self) -> bool:
        """As the valve inside."""
        return self.inner.memoryless

    def force(
        self, velocity: Values, side: Values, peak_velocity: Values, current: Values
    ) -> Values:
        """Force, N; see `Valve.force`."""
        fluid = self.inner.force(velocity, side, peak_velocity, np.zeros_like(current))
        whole = self.inner.force(velocity, side, peak_velocity, current)
        return self.fluid * fluid + self.field * (whole - fluid)


@dataclass(frozen=True, kw_only=True)
class VogelOil(Planter):
    """Carrier oil whose viscosity follows Vogel's law in the recorded temperature.

    Attributes:
        size: −d ln η/dT at 40 °C, 1/K.
    """

    name: ClassVar[str] = "vogel_oil"
    causes: ClassVar[tuple[str, ...]] = ("viscosity_temperature",)
    family: ClassVar[str | None] = "thermal"
    stage: ClassVar[Stage] = "law"
    size: float = 5.0e-3

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        ratio = vogel_ratio(state.temperature, self.size)[:, None]
        return state.with_valve(valve=ScaledFluid(state.valve, ratio, np.ones_like(ratio)))


@dataclass(frozen=True, kw_only=True)
class WarmParticles(Planter):
    """Chains weaken with temperature as the particles' magnetization squared: (1 − κ T^1.5)².

    Bloch's law for the magnetization, with the constant from the slope at 40 °C.

    Attributes:
        size: −d ln τ_y/dT at 40 °C, 1/K.
    """

    name: ClassVar[str] = "warm_particles"
    causes: ClassVar[tuple[str, ...]] = ("yield_temperature",)
    family: ClassVar[str | None] = "thermal"
    stage: ClassVar[Stage] = "law"
    size: float = 3.0e-3

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        reference, kelvin = 313.15, state.temperature[:, None] + 273.15
        share = self.size * reference / (3.0 + self.size * reference)
        kappa = share / reference**1.5
        ratio = ((1.0 - kappa * kelvin**1.5) / (1.0 - kappa * reference**1.5)) ** 2
        return state.with_valve(valve=ScaledFluid(state.valve, np.ones_like(ratio), ratio))


@dataclass(frozen=True, kw_only=True)
class RelaxingChains(Planter):
    """Chains with a broad spectrum of relaxation times are stronger the faster the test.

    The stress amplitude follows the modulus of Cole and Cole's element,
    |1 + Δ (iωτ)^β / (1 + (iωτ)^β)|, over that at 1 Hz.

    Attributes:
        size: Δ.
        time: τ, s.
        breadth: β, smaller is broader.
    """

    name: ClassVar[str] = "relaxing_chains"
    causes: ClassVar[tuple[str, ...]] = ("frequency_law",)
    family: ClassVar[str | None] = "rate_law"
    stage: ClassVar[Stage] = "law"
    size: float = 0.2
    time: float = 0.15
    breadth: float = 0.45

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        ratio = (self.modulus(state.frequency) / self.modulus(np.ones(1)))[:, None]
        return state.with_valve(valve=ScaledFluid(state.valve, ratio, ratio))

    def modulus(self, frequency: Values) -> Values:
        """Stress amplitude, 1 where nothing is relaxed, [...]."""
        relaxed = (2j * np.pi * frequency * self.time) ** self.breadth
        return np.abs(1.0 + self.size * relaxed / (1.0 + relaxed))
