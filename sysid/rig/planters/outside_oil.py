"""Effects outside the catalogue: the oil, its valves and its chambers."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.lugre import lugre_force
from sysid.rig.planters.periodic import periodic_recurrence
from sysid.rig.planters.planter import Planter, Stage


@dataclass(frozen=True, kw_only=True)
class ThixotropicOil(Planter):
    """Structure that builds up at rest and is torn by shear: λ' = (1 − λ)/t_r − b |v| λ.

    The fluid part of the force is 1 + s (λ − ½) times what it was.

    Attributes:
        size: s.
        recovery_time: t_r, s.
        tearing: b, 1/m.
    """

    name: ClassVar[str] = "thixotropic_oil"
    causes: ClassVar[tuple[str, ...]] = ()
    family: ClassVar[str | None] = "rate_law"
    stage: ClassVar[Stage] = "force"
    size: float = 0.2
    recovery_time: float = 0.3
    tearing: float = 60.0

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        return state.adding(self.size * (self.structure(state) - 0.5) * state.fluid_part())

    def structure(self, state: BenchState) -> np.ndarray:
        """λ in the steady state, [L, P]."""
        speed = np.abs(state.velocity)
        rate = 1.0 / self.recovery_time + self.tearing * 0.5 * (speed + np.roll(speed, -1, axis=1))
        kept = np.exp(-rate * state.time_step[:, None])
        return periodic_recurrence(kept, (1.0 - kept) / (self.recovery_time * rate))


@dataclass(frozen=True, kw_only=True)
class CollapsingBubble(Planter):
    """A vapour bubble under the piston collapses in every compression stroke and hammers.

    When the stroke has closed the bubble, the column of oil stops: ρ c v on the piston's area
    (Joukowsky), as a half sine that lasts as long as the wave needs to and fro.

    Attributes:
        size: Piston area that the hammer reaches, m².
        bubble: Travel that closes it, m.
        duration: Of the pulse, s.
        density: kg/m³.
        sound: Speed of sound, m/s.
    """

    name: ClassVar[str] = "collapsing_bubble"
    causes: ClassVar[tuple[str, ...]] = ()
    family: ClassVar[str | None] = "lost_motion"
    stage: ClassVar[Stage] = "force"
    size: float = 4.0e-4
    bubble: float = 1.0e-3
    duration: float = 5.0e-3
    density: float = 3000.0
    sound: float = 1000.0

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        a = state.amplitude[:, None]
        omega = 2.0 * np.pi * state.frequency[:, None]
        start = np.arccos(np.clip(1.0 - self.bubble / a, -1.0, 1.0))
        speed = a * omega * np.sin(start)
        points = state.displacement.shape[1]
        turned = (2.0 * np.pi * (np.arange(points) / points - 0.75)) % (2.0 * np.pi)
        lasting = np.maximum(self.duration, 4.0 * state.time_step[:, None])
        clock = (turned - start) / omega
        pulse = np.where((clock > 0.0) & (clock < lasting), np.sin(np.pi * clock / lasting), 0.0)
        return state.adding(self.density * self.sound * speed * self.size * pulse)


@dataclass(frozen=True, kw_only=True)
class CheckValve(Planter):
    """A spring-loaded valve opens in compression above a pressure and lets oil by.

    Attributes:
        size: Share of the force above the opening force that is relieved.
        opening: Opening force, as a share of the campaign's highest.
    """

    name: ClassVar[str] = "check_valve"
    causes: ClassVar[tuple[str, ...]] = ()
    family: ClassVar[str | None] = "offset"
    stage: ClassVar[Stage] = "force"
    size: float = 0.2
    opening: float = 0.4

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        opens = self.opening * state.strongest
        return state.adding(-self.size * np.maximum(state.force - opens, 0.0))


@dataclass(frozen=True, kw_only=True)
class ShimStack(Planter):
    """A stack of shims beside the valve: its second spring yields above a speed.

    Attributes:
        size: Slope before, N·s/m.
        opening_speed: m/s.
        after: Slope afterwards, as a share.
    """

    name: ClassVar[str] = "shim_stack"
    causes: ClassVar[tuple[str, ...]] = ()
    family: ClassVar[str | None] = "viscous"
    stage: ClassVar[Stage] = "force"
    dissipates: ClassVar[bool] = True
    size: float = 400.0
    opening_speed: float = 0.08
    after: float = 0.1

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        speed = np.abs(state.velocity)
        slow = np.minimum(speed, self.opening_speed)
        return state.adding(
            self.size * (slow + self.after * (speed - slow)) * np.sign(state.velocity)
        )


@dataclass(frozen=True, kw_only=True)
class StickingPiston(Planter):
    """The floating piston between oil and gas sticks, and the oil yields a little meanwhile.

    With x the rod's travel and y the floating piston's, both as travel of the rod, the oil
    carries k_o (x − y); the floating piston moves while that differs from the gas force k y by
    its friction k ξ.  So y is a play of k_o x / (k_o + k) with half width ξ k / (k_o + k).

    Attributes:
        size: Stiffness k of the gas, N/m.
        oil: k_o / k.
        sticking: ξ, m.
    """

    name: ClassVar[str] = "sticking_piston"
    causes: ClassVar[tuple[str, ...]] = ()
    family: ClassVar[str | None] = None
    stage: ClassVar[Stage] = "force"
    dissipates: ClassVar[bool] = True
    size: float = 600.0
    oil: float = 12.0
    sticking: float = 0.05

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        half = self.sticking / (self.oil + 1.0)
        share = self.oil / (self.oil + 1.0)
        reach = np.maximum(share * state.amplitude[:, None] - half, 0.0)
        followed = np.maximum(share * state.travel_since_reversal - 2.0 * half, 0.0)
        floating = np.sign(state.velocity) * (followed - reach)
        return state.adding(self.size * self.oil * (state.displacement - floating))


@dataclass(frozen=True, kw_only=True)
class OneSidedLip(Planter):
    """A seal lip that presses only while the rod moves in.

    Attributes:
        size: Friction, N.
        stiffness: Of the lip, N/m.
    """

    name: ClassVar[str] = "one_sided_lip"
    causes: ClassVar[tuple[str, ...]] = ()
    family: ClassVar[str | None] = "friction"
    stage: ClassVar[Stage] = "force"
    size: float = 40.0
    stiffness: float = 2.0e6

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        slip = np.where(state.velocity > 0.0, self.size, 0.0)
        return state.adding(lugre_force(state, slip, self.stiffness))
