"""Gains for a damper: Ziegler and Nichols' for PID, a search for feedback linearisation."""

from dataclasses import dataclass
from typing import Any, Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from scipy.signal import detrend

from sysid.errors import DataError
from sysid.isolator.base_motion import BaseMotion
from sysid.isolator.closed_loop import CLOCK, Clock, sampled, trace
from sysid.isolator.controllers.base import AbstractController
from sysid.isolator.controllers.gain_schedule import SPEED
from sysid.isolator.controllers.proportional import Proportional
from sysid.isolator.damper_step import AbstractDamperStep
from sysid.isolator.families import Family
from sysid.isolator.implicit_stage import Port
from sysid.isolator.lumped_step import LumpedStep
from sysid.isolator.plant import Number, Plant, mass_isolator
from sysid.isolator.pointwise_step import PointwiseStep
from sysid.isolator.skyhook import Sensed
from sysid.isolator.study import conflict_diagram, stacked

FEEDBACKS: Final = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
"""B that are tried."""
FEEDFORWARDS: Final = (0.6, 1.2, 2.4, 4.8, 9.6)
"""G that are tried, times the damper's own newtons per ampere."""
_SECONDS: Final = 0.4
_LADDER: Final = np.geomspace(0.1, 40.0, 48)
"""Gains on the way to the ultimate one, times the damper's newtons per ampere: 14 % apart."""
_NEAR: Final = 0.5
"""Of the current, to either side, over which newtons per ampere are taken."""
_ALIVE: Final = 0.7
"""An oscillation whose second half is at least so large as its first does not die out."""


@dataclass(frozen=True)
class Ultimate:
    """Where a proportional force loop begins to oscillate.

    Attributes:
        gain: K_u, A/N.
        period: T_u, s.
    """

    gain: float
    period: float

    @property
    def pid(self) -> tuple[float, float, float]:
        """K_p = 0.6 K_u, K_i = 2 K_p/T_u and K_d = K_p T_u/8 (Ziegler and Nichols)."""
        gain = 0.6 * self.gain
        return gain, 2.0 * gain / self.period, gain * self.period / 8.0


class _Steadied(AbstractDamperStep):
    """A damper that stays in the middle of its stroke, however far its piston goes.

    Attributes:
        inner: The damper.
        tau: Its own, s.
        currents: Its own, A.
    """

    inner: AbstractDamperStep
    tau: Number
    currents: tuple[float, ...] = eqx.field(static=True)

    def start(self) -> Any:
        """As the damper."""
        return self.inner.start()

    def stage(self, known: Any, meets: Port, current: Number) -> tuple[Any, Number]:
        """Without its place."""
        none = jnp.zeros_like(meets.displacement)
        return self.inner.stage(known, meets._replace(displacement=none, shift=none), current)

    def carried(self, begin: Any, first: Any) -> Any:
        """As the damper."""
        return self.inner.carried(begin, first)


def _steadied(damper: AbstractDamperStep) -> _Steadied:
    return _Steadied(inner=damper, tau=damper.tau, currents=damper.currents)


class _Follower(AbstractController):
    """Proportional control of the force towards a constant one, about a current.

    Attributes:
        gain: A/N.
        force: Wanted, N.
        current: A that would give it at rest of the loop.
    """

    gain: Number
    force: Number
    current: Number

    def start(self) -> tuple[()]:
        """Nothing."""
        return ()

    def command(
        self, memory: tuple[()], sensed: Sensed, period: Number
    ) -> tuple[tuple[()], Number]:
        """About the current."""
        return memory, self.current + self.gain * (self.force - sensed.force)


def ultimate(
    damper: AbstractDamperStep,
    table: LumpedStep | PointwiseStep,
    speed: float = SPEED,
    clock: Clock = CLOCK,
) -> Ultimate:
    """The ultimate gain and period of a damper's force loop, its piston at a steady speed.

    The wanted force is that of half the largest current, stepped to from there by 5 %, so neither
    end of the current is met before the loop oscillates.

    Args:
        damper: At its temperature.
        table: Its force at a steady speed.
        speed: Of the piston, m/s.
        clock: Time steps; how often the controller samples decides what is found.

    Raises:
        DataError: No gain that is tried makes it oscillate, or its force does not rise with
            current.

    Source:
        J. G. Ziegler, N. B. Nichols, Optimum settings for automatic controllers, Trans. ASME 64
        (1942).
    """
    half = jnp.asarray(0.5 * damper.largest_current)
    force, ladder = table.at_speed(speed, half[None])[0], _LADDER / per_ampere(table, speed)
    count = round(_SECONDS / clock.period)
    time = clock.period * np.arange(count + 1)
    ramp = speed * np.where(time < 0.02, time**2 / 0.04, time - 0.01)
    one = jax.tree.map(lambda z: z[0], sampled(BaseMotion(clock.period, ramp[None], "ramp"), clock))
    middle = _steadied(damper)

    def oscillating(gain: Number) -> jax.Array:
        follower = _Follower(gain, 1.05 * force, half)
        return trace(mass_isolator(1e9, 1.0), middle, follower, one, clock).force

    forces = np.asarray(jax.jit(jax.vmap(oscillating))(jnp.asarray(ladder)))
    late = forces[:, count // 2 :]
    first, second = (detrend(z, axis=1) for z in np.array_split(late, 2, axis=1))
    alive = (second.std(axis=1) > _ALIVE * first.std(axis=1)) & (
        second.std(axis=1) > 1e-4 * abs(float(force))
    )
    if not np.any(alive):
        raise DataError(
            f"no gain up to {ladder[-1]:.3g} A/N makes the force loop oscillate",
            advice="Ziegler and Nichols' rule cannot be used here; give the gains",
        )
    at = int(np.argmax(alive))
    # zero-padded, since a sample is a large part of a period
    spectrum = np.abs(np.fft.rfft(second[at] * np.hanning(second.shape[1]), 1 << 14))
    frequency = np.fft.rfftfreq(1 << 14, clock.period)[int(np.argmax(spectrum[1:])) + 1]
    return Ultimate(float(ladder[at]), float(1.0 / frequency))


def per_ampere(table: LumpedStep | PointwiseStep, speed: float = SPEED) -> float:
    """By how much the force at a steady speed rises with current, about half the largest, N/A.

    Args:
        table: The force at a steady speed.
        speed: m/s.

    Raises:
        DataError: It does not.
    """
    ends = 0.5 * table.largest_current * np.array([1.0 - _NEAR, 1.0 + _NEAR])
    low, high = np.asarray(table.at_speed(speed, jnp.asarray(ends))).tolist()
    if not high > low:
        raise DataError(
            f"the damper's force does not rise with current: at {speed:g} m/s it is {low:.4g} N "
            f"at {ends[0]:.3g} A and {high:.4g} N at {ends[1]:.3g} A",
            advice="No controller of its current can be tuned",
        )
    return float((high - low) / (ends[1] - ends[0]))


@dataclass(frozen=True)
class Searched:
    """Feedback linearisation over a grid of gains, at one D.

    Attributes:
        feedbacks: [n] B.
        feedforwards: [n] G, A/N.
        judged: [n] RMS acceleration over that at 0 A plus RMS working space over that at 0 A.
    """

    feedbacks: tuple[float, ...]
    feedforwards: tuple[float, ...]
    judged: np.ndarray

    @property
    def best(self) -> tuple[float, float]:
        """B and G with the least sum."""
        at = int(np.argmin(self.judged))
        return self.feedbacks[at], self.feedforwards[at]


def search_feedback(
    plant: Plant,
    damper: AbstractDamperStep,
    slope: float,
    base: BaseMotion,
    damping: float,
    clock: Clock = CLOCK,
) -> Searched:
    """Try B and G on motions, and judge acceleration and working space alike.

    Args:
        plant: The plant.
        damper: At its temperature.
        slope: Of its force over current, N/A (`per_ampere`).
        base: Motions.
        damping: D, N·s/m.
        clock: Time steps.

    Raises:
        DataError: Every run runs away.
    """
    # G = 0 is no current at all, by which the others are measured
    grid = [(0.0, 0.0), *((b, g / slope) for b in FEEDBACKS for g in FEEDFORWARDS)]
    controllers = stacked([
        Proportional(*(jnp.asarray(z) for z in (damping, b, g))) for b, g in grid
    ])  # fmt: skip
    one = Family("P", tuple(float(k) for k in range(len(grid))), "-", controllers)
    curve = conflict_diagram(plant, [one], stacked([damper]), ("damper",), base, clock).curves[0]
    found = [z[:, 0].mean(axis=1) for z in (curve.acceleration, curve.working_space)]
    with np.errstate(invalid="ignore"):
        judged = np.sum([z[1:] / z[0] for z in found], axis=0)
    judged = np.where(np.isfinite(judged), judged, np.inf)
    if not np.isfinite(judged).any():
        raise DataError(
            "no gains could be found: the damper runs away on these motions",
            advice="They are faster than its tests; leave --tune out",
        )
    return Searched(tuple(b for b, _ in grid[1:]), tuple(g for _, g in grid[1:]), judged)
