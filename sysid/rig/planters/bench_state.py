"""Steady tests on the bench, as a hidden effect finds and leaves them."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from jaxtyping import Bool, Float, Int

from sysid.rig.planters.valve import Valve

Grid = Float[np.ndarray, "loop phase"]
PerLoop = Float[np.ndarray, " loop"]
Column = Float[np.ndarray, "loop #phase"]

POINTS: Final = 720
"""Points a cycle on which the physics is solved."""
CORNER: Final = 9
"""Harmonics of a triangle wave that the actuator still follows."""


@dataclass(frozen=True)
class BenchState:
    """L tests in steady motion x = A sin φ, one cycle each on φ_j = 2πj/P.

    Forces resist the motion, compression positive.

    Attributes:
        amplitude: [L] m.
        frequency: [L] Hz.
        current: [L] A, as set and recorded.
        temperature: [L] °C, as recorded.
        run_order: [L] position in the campaign, from 1.
        cycles: Steady cycles that are recorded.
        displacement: [L, P] m, of the rod.
        velocity: [L, P] m/s, of the rod.
        acceleration: [L, P] m/s², of the rod.
        side: [L, P] sign of the acceleration, 0 where it is 0.
        valve: What makes the damper's force.
        valve_velocity: [L, P] m/s, at the valve.
        valve_current: [L, 1] A, that the field follows.
        force: [L, P] N, what reaches the recorder, mean over the cycles.
        departures: [L, C, P] N, of each cycle from that mean.
        triangular: [L] the rod goes at constant speed, with rounded corners; none does if None.
        built_for: The first so many tests are those for which damper and rig were built; all if
            None.
        stroke: m, farthest that the rig goes, for which they were built too; no farther if None.
    """

    amplitude: PerLoop
    frequency: PerLoop
    current: PerLoop
    temperature: PerLoop
    run_order: Int[np.ndarray, " loop"]
    cycles: int
    displacement: Grid
    velocity: Grid
    acceleration: Grid
    side: Grid
    valve: Valve
    valve_velocity: Grid
    valve_current: Column
    force: Grid
    departures: Float[np.ndarray, "loop cycle phase"] | None = None
    triangular: Bool[np.ndarray, " loop"] | None = None
    built_for: int | None = None
    stroke: float | None = None

    @property
    def widest(self) -> float:
        """Largest amplitude for which damper and rig were built, m."""
        if self.stroke is not None:
            return self.stroke
        return float(np.max(self.amplitude[: self.built_for]))

    @property
    def strongest(self) -> float:
        """Largest force for which they were built, as it is here, N."""
        return float(np.max(np.abs(self.force[: self.built_for])))

    @property
    def peak_velocity(self) -> Column:
        """v_m, m/s: Aω, [L, 1]; √(v² − ax) of every point, [L, P], where a test is no sine."""
        of_sine = (2.0 * np.pi * self.frequency * self.amplitude)[:, None]
        if self.triangular is None or not self.triangular.any():
            return of_sine
        inside = self.velocity**2 - self.acceleration * self.displacement
        return np.where(self.triangular[:, None], np.sqrt(np.maximum(inside, 0.0)), of_sine)

    @property
    def time_step(self) -> PerLoop:
        """Of the phase grid, [L] s."""
        return 1.0 / (self.frequency * self.displacement.shape[1])

    @property
    def travel_since_reversal(self) -> Grid:
        """Of the rod, [L, P] m."""
        ahead = np.where(self.velocity > 0.0, self.displacement, -self.displacement)
        return self.amplitude[:, None] + ahead

    def valve_force(self, velocity: Grid | None = None, current: Column | None = None) -> Grid:
        """Force of the valve, [L, P] N.

        Args:
            velocity: [L, P] m/s instead of `valve_velocity`.
            current: [L, 1] or [L, P] A instead of `valve_current`.
        """
        v = self.valve_velocity if velocity is None else velocity
        i = self.valve_current if current is None else current
        return self.valve.force(v, self.side, self.peak_velocity, i)

    def field_part(self) -> Grid:
        """What the field adds to the valve's force, [L, P] N: F(i) − F(0 A)."""
        return self.valve_force() - self.fluid_part()

    def fluid_part(self) -> Grid:
        """The valve's force without field, [L, P] N."""
        return self.valve_force(current=np.zeros_like(self.valve_current))

    def adding(self, force: Grid) -> "BenchState":
        """The same with a force in parallel, [L, P] N."""
        return replace(self, force=self.force + force)

    def recording(self, force: Grid) -> "BenchState":
        """The same with another force at the recorder, [L, P] N."""
        return replace(self, force=force)

    def with_valve(
        self,
        valve: Valve | None = None,
        velocity: Grid | None = None,
        current: Column | None = None,
    ) -> "BenchState":
        """The same with another valve, velocity of it, m/s, or field, A; its force follows."""
        changed = replace(
            self,
            valve=self.valve if valve is None else valve,
            valve_velocity=self.valve_velocity if velocity is None else velocity,
            valve_current=self.valve_current if current is None else current,
        )
        return replace(changed, force=changed.valve_force())


def steady_bench(
    valve: Valve,
    amplitude: PerLoop,
    frequency: PerLoop,
    current: PerLoop,
    *,
    temperature: PerLoop | None = None,
    run_order: Int[np.ndarray, " loop"] | None = None,
    cycles: int = 8,
    points: int = POINTS,
    triangular: Bool[np.ndarray, " loop"] | None = None,
    built_for: int | None = None,
    stroke: float | None = None,
) -> BenchState:
    """Tests without any hidden effect.

    Args:
        valve: In the bench.
        amplitude: [L] m.
        frequency: [L] Hz.
        current: [L] A.
        temperature: [L] °C; 40 everywhere if not given.
        run_order: [L] from 1; as listed if not given.
        cycles: Steady cycles that are recorded.
        points: P.
        triangular: [L] constant speed between rounded corners instead of a sine wave.
        built_for: How many tests, from the first, damper and rig were built for; all if None.
        stroke: m, amplitude that they were built for, whatever is tested; that of tests if None.
    """
    phase = 2.0 * np.pi * np.arange(points) / points
    omega = 2.0 * np.pi * frequency[:, None]
    x = amplitude[:, None] * np.sin(phase)
    j = np.arange(points)
    side = np.where((2 * j) % points == 0, 0.0, -np.sign(points - 2.0 * j))
    v = omega * amplitude[:, None] * np.cos(phase)
    acceleration = -(omega**2) * x
    side = np.broadcast_to(side, x.shape)
    if triangular is not None and triangular.any():
        which = triangular[:, None]
        shape, slope, bend = _triangle(phase)
        x = np.where(which, amplitude[:, None] * shape, x)
        v = np.where(which, omega * amplitude[:, None] * slope, v)
        acceleration = np.where(which, omega**2 * amplitude[:, None] * bend, acceleration)
        side = np.where(which, np.sign(acceleration), side)
    still = BenchState(
        amplitude=amplitude,
        frequency=frequency,
        current=current,
        temperature=np.full(amplitude.shape, 40.0) if temperature is None else temperature,
        run_order=np.arange(1, amplitude.size + 1) if run_order is None else run_order,
        cycles=cycles,
        displacement=x,
        velocity=v,
        acceleration=acceleration,
        side=side,
        valve=valve,
        valve_velocity=v,
        valve_current=current[:, None],
        force=np.zeros_like(x),
        triangular=triangular,
        built_for=built_for,
        stroke=stroke,
    )
    return replace(still, force=still.valve_force())


def _triangle(phase: Float[np.ndarray, " phase"]) -> tuple[Float[np.ndarray, " phase"], ...]:
    """A triangle wave as an actuator does it, and its first two derivatives with phase."""
    order = np.arange(1.0, CORNER + 1.0, 2.0)
    size = 8.0 / np.pi**2 * np.where(order % 4.0 == 1.0, 1.0, -1.0) / order**2
    angle = np.outer(phase, order)
    return np.sin(angle) @ size, np.cos(angle) @ (order * size), -np.sin(angle) @ (order**2 * size)
