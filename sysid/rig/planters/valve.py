"""Valves that a hidden effect sits in, for many tests at once.

`HystereticValve` follows the law of `sysid.rig.damper`, vectorised over tests, with a factor on
each of four of its laws by which a real damper departs from it.  `BoucWenValve` is of another
model class altogether.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from jaxtyping import Float

Values = Float[np.ndarray, "..."]
Column = Float[np.ndarray, "#loop 1"]

_ONE = np.ones((1, 1))


class Valve(Protocol):
    """What makes the damper's force.

    Attributes:
        memoryless: The force follows from the instant alone, so that it can be asked for at one
            point; else only whole loops, [L, P], may be given.
    """

    @property
    def memoryless(self) -> bool:
        """Whether single points may be asked for."""
        ...

    def force(
        self, velocity: Values, side: Values, peak_velocity: Values, current: Values
    ) -> Values:
        """Force that resists the motion, N, [..., L, P].

        Args:
            velocity: At the valve, [..., L, P] m/s.
            side: Sign of the rod's acceleration, [L, P] or [L, 1].
            peak_velocity: Of the test, [L, 1] m/s.
            current: That the field follows, [L, 1] or [L, P] A.
        """
        ...


@dataclass(frozen=True)
class LawFactors:
    """Factors on laws of `HystereticValve`, one a test, [L, 1]: 1 is the law as published."""

    transition: Column = field(default_factory=lambda: _ONE)
    gain: Column = field(default_factory=lambda: _ONE)
    width: Column = field(default_factory=lambda: _ONE)
    growth: Column = field(default_factory=lambda: _ONE)


@dataclass(frozen=True)
class HystereticValve:
    """W11 Eqs. 3–9.

    Attributes:
        parameters: Symbol → value of the 16 parameters, SI.
        factors: Departures from the laws F_t, C_i, v_h and k_v.
    """

    parameters: Mapping[str, float]
    factors: LawFactors = field(default_factory=LawFactors)

    @property
    def memoryless(self) -> bool:
        """Yes: beside the sign of the acceleration nothing of the past counts."""
        return True

    def force(
        self, velocity: Values, side: Values, peak_velocity: Values, current: Values
    ) -> Values:
        """Force, N; see `Valve.force`."""
        p, laws, v_m = self.parameters, self.factors, peak_velocity
        rise = self._rise("a_2", "I_0", current)
        gain = np.maximum(1.0, 1.0 + p["k_2"] * rise) * laws.gain
        width = p["k_4"] * (1.0 + p["k_3"] * self._rise("a_3", "I_1", current)) * laws.width * v_m
        transition = p["F_0"] * (1.0 + np.exp(p["a_1"] * v_m)) * laws.transition
        steepness = p["a_0"] / (1.0 + p["k_0"] * v_m)
        shifted = velocity + side * width + p["k_6"] * v_m
        decay = np.exp(-p["a_4"] * v_m) * laws.growth
        growth = 1.0 + np.where(velocity < 0.0, p["k_1e"], p["k_1c"]) * decay * np.abs(velocity)
        offset = p["k_5"] * gain * transition
        return gain * (transition * np.tanh(0.5 * steepness * shifted) - offset) * growth

    def _rise(self, steepness: str, start: str, current: Values) -> Values:
        """σ(a (i + I)) − σ(a I)."""
        a, offset = self.parameters[steepness], self.parameters[start]
        return 0.5 * (np.tanh(0.5 * a * (current + offset)) - np.tanh(0.5 * a * offset))


@dataclass(frozen=True)
class BoucWenValve:
    """F = c(i) v + α(i) z, z' = v (1 − z²) / x_y while loading and v / x_y while unloading.

    The Bouc–Wen equation with exponent 2 and equal β and γ, z scaled to 1.  Within a step of
    the grid the rod moves one way, and the equation has a solution in closed form: arctanh z
    grows with travel while loading, z itself while unloading.

    Attributes:
        time_step: Of the phase grid, [L, 1] s.
        yield_travel: x_y, m.
        viscosity: c at 0 A, and what each ampere adds, N·s/m.
        strength: α at 0 A, and what saturates with current, N.
        saturation: Current at which tanh(i/i_s) makes α saturate, A.
    """

    time_step: Column
    yield_travel: float = 0.7e-3
    viscosity: tuple[float, float] = (600.0, 1800.0)
    strength: tuple[float, float] = (110.0, 900.0)
    saturation: float = 0.25

    @property
    def memoryless(self) -> bool:
        """No: z depends on the path."""
        return False

    def force(
        self, velocity: Values, side: Values, peak_velocity: Values, current: Values
    ) -> Values:
        """Force, N; whole loops only, see `Valve.force`."""
        step = velocity * self.time_step / self.yield_travel
        z = np.zeros(velocity.shape[0])
        path = np.empty_like(velocity)
        points = velocity.shape[1]
        for j in range(2 * points):
            path[:, j % points] = z
            move = 0.5 * (step[:, j % points] + step[:, (j + 1) % points])
            z = _load(z, move)
        c = self.viscosity[0] + self.viscosity[1] * current
        alpha = self.strength[0] + self.strength[1] * np.tanh(current / self.saturation)
        return c * velocity + alpha * path


def _load(z: Float[np.ndarray, " loop"], move: Float[np.ndarray, " loop"]) -> np.ndarray:
    """Z after a travel, in units of the yield travel."""
    along = np.where(move < 0.0, -1.0, 1.0) * np.clip(z, -1.0 + 1e-15, 1.0 - 1e-15)
    stretched = np.where(along < 0.0, along, np.arctanh(np.maximum(along, 0.0))) + np.abs(move)
    after = np.where(stretched < 0.0, stretched, np.tanh(np.maximum(stretched, 0.0)))
    return np.where(move < 0.0, -1.0, 1.0) * after
