"""A pocket of gas behind the piston that every compression stroke has to close first."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float

from sysid.errors import DataError
from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.planter import Planter, Stage
from sysid.rig.planters.roots import rising_root

PerLoop = Float[np.ndarray, " loop"]


@dataclass(frozen=True, kw_only=True)
class GasPocket(Planter):
    """Oil that failed to refill one chamber leaves a pocket of length δ.

    On the next stroke into that chamber the pocket closes as p hⁿ stays constant and takes up
    travel that the valve does not see, ẋ = u + ḋ, with its pressure in balance with the valve's
    force above the force at rest.  On the other stroke it opens again without force.

    Attributes:
        size: Length of the pocket at its own pressure, m of travel.
        pocket_force: Its pressure on the piston, N.
        exponent: n.
    """

    name: ClassVar[str] = "gas_pocket"
    causes: ClassVar[tuple[str, ...]] = ("entrained_air",)
    family: ClassVar[str | None] = "lost_motion"
    stage: ClassVar[Stage] = "motion"
    size: float = 1.0e-4
    pocket_force: float = 30.0
    exponent: float = 1.2

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them.

        Raises:
            DataError: The valve has a memory of its own.
        """
        if self.size == 0.0:
            return state
        if not state.valve.memoryless:
            raise DataError("a pocket before this valve cannot be solved point by point")
        return state.with_valve(velocity=self._behind_the_pocket(state))

    def closed(self, force: Float[np.ndarray, "..."]) -> Float[np.ndarray, "..."]:
        """Travel by which the pocket is closed under a force above that at rest, [...] m."""
        pressure = 1.0 + np.maximum(force, 0.0) / self.pocket_force
        return self.size * (1.0 - pressure ** (-1.0 / self.exponent))

    def _behind_the_pocket(self, state: BenchState) -> Float[np.ndarray, "loop phase"]:
        """Velocity of the valve, [L, P]; implicit Euler along the compression stroke."""
        points = state.displacement.shape[1]
        v, v_m, current = state.valve_velocity, state.peak_velocity, state.valve_current
        dt, valve = state.time_step, state.valve

        def force(u: PerLoop, j: int) -> PerLoop:
            return valve.force(u[:, None], state.side[:, [j]], v_m, current)[:, 0]

        start = 3 * points // 4
        rest = force(np.zeros_like(dt), start)
        d = np.zeros_like(dt)
        u = v.copy()
        for step in range(start + 1, start + points // 2):
            j = step % points
            supply = d + dt * v[:, j]

            def excess(u: PerLoop, j: int = j, supply: PerLoop = supply) -> PerLoop:
                return self.closed(force(u, j) - rest) + dt * u - supply

            u[:, j] = rising_root(excess, np.zeros_like(dt), supply / dt, tolerance=1e-7)
            d = supply - dt * u[:, j]
        return u
