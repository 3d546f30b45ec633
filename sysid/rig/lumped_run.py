"""A whole test of the lumped damper, from rest, in small implicit steps, while its oil heats."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.rig.elementary import exp
from sysid.rig.lumped_damper import LumpedDamper

Samples = Float[np.ndarray, " n"]

GAMMA: Final = 1.0 - math.sqrt(0.5)
"""Diagonal of the two-stage method of second order that damps what is too fast to follow."""
LONGEST_STEP: Final = 40e-6
"""s.  On Table 1 the force then departs from the true solution by less than 0.1 % of its largest
value (tests/rig/test_lumped_run.py)."""


@dataclass(frozen=True)
class Heat:
    """The heat balance of a damper, all of it at one temperature: m c dT/dt = F v − h (T − T_a).

    Attributes:
        capacity: m c, J/K.
        loss: h, W/K.
        ambient: T_a, °C.
        lag: Time constant of the thermometer, s.
    """

    capacity: float = 600.0
    loss: float = 1.5
    ambient: float = 22.0
    lag: float = 1.0

    def rested(self, temperature: float, pause: float) -> float:
        """Temperature after a pause, °C, from that before it."""
        left = float(exp(np.asarray(-pause * self.loss / self.capacity)))
        return self.ambient + (temperature - self.ambient) * left


@dataclass(frozen=True)
class Course:
    """What happened in a test, at the recorder's times.

    Attributes:
        force: [n] N on the piston, gas force included.
        oil: [n] °C.
        thermometer: [n] °C.
    """

    force: Samples
    oil: Samples
    thermometer: Samples


def run_damper(
    damper: LumpedDamper,
    heat: Heat,
    velocity: Callable[[Samples], Samples],
    time: Samples,
    current: float,
    frequency: float,
    temperature: float,
    longest_step: float = LONGEST_STEP,
) -> Course:
    r"""Drive a damper that rests with a relaxed spring.

    u is the deflection of the spring, w the speed of the mass:

        u̇ = ẋ − w,    m_l ẇ = k u − χ(w),    F = k u + F_gas

    A diagonally implicit Runge–Kutta method of two stages (Alexander 1977; second order, L-stable,
    stiffly accurate) with equal steps.  χ is a broken line that rises, so that the equation of a
    stage is solved exactly, by telling on which of its pieces the solution lies.  Nothing but sums,
    products and quotients: the same bits on every machine.  The element has in each interval
    between two samples its values at the temperature at the interval's start.

    Args:
        damper: At rest.
        heat: Its heat balance.
        velocity: Of the piston, m/s, at times [n].
        time: [n] s, equally spaced; the damper rests before.
        current: A.
        frequency: Of the motion, Hz; it counts only for a fluid with memory.
        temperature: At the start, °C, of oil and thermometer.
        longest_step: s.
    """
    interval = float(time[1] - time[0])
    parts = math.ceil(interval / longest_step)
    h = interval / parts
    at = time[:-1, None] + h * np.arange(parts)
    first = velocity((at + GAMMA * h).ravel()).reshape(-1, parts).tolist()
    second = velocity((at + h).ravel()).reshape(-1, parts).tolist()
    u, w, oil, felt = 0.0, 0.0, temperature, temperature
    element = damper.element(current, oil, frequency)
    force, oils, thermometer = [element.gas_force], [oil], [felt]
    g, further = GAMMA * h, (1.0 - GAMMA) / GAMMA
    share = interval / (heat.lag + interval)
    for early, late in zip(first, second, strict=True):
        k, mass, f_y = element.stiffness, element.mass, element.yield_force
        p, q = g * k / mass, g / mass
        slow = 1.0 + g * p + q * element.pre_yield
        fast = 1.0 + g * p + q * element.post_yield
        step = q * f_y
        limit = slow * f_y / (element.pre_yield - element.post_yield)
        work = 0.0
        for x_1, x_2 in zip(early, late, strict=True):
            r = w + p * (u + g * x_1)
            w_1 = r / slow if -limit <= r <= limit else (r - step if r > 0.0 else r + step) / fast
            u_1 = u + g * (x_1 - w_1)
            w, u = w + further * (w_1 - w), u + further * (u_1 - u)
            r = w + p * (u + g * x_2)
            w = r / slow if -limit <= r <= limit else (r - step if r > 0.0 else r + step) / fast
            u = u + g * (x_2 - w)
            work += u * x_2
        oil += (h * k * work - heat.loss * (oil - heat.ambient) * interval) / heat.capacity
        felt += share * (oil - felt)
        element = damper.element(current, oil, frequency)
        force.append(k * u + element.gas_force)
        oils.append(oil)
        thermometer.append(felt)
    return Course(np.array(force), np.array(oils), np.array(thermometer))
