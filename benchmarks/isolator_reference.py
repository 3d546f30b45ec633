"""A mass on a spring and the lumped damper under skyhook control, as SciPy solves it.

Written apart from `sysid.isolator`: nothing but the equations is shared.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from lumped_reference import C_PRE, numbers
from lumped_reference import MASS as FLUID_MASS
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

LAG: Final = 0.003
LARGEST: Final = 1.0
Law = Callable[[float, float, float], float]
"""Velocity of the mass, compression rate, force → current, A."""
PERIOD: Final = 1e-3
"""s, of the PID controller."""


@dataclass(frozen=True)
class Isolator:
    """Plant and temperature.

    Attributes:
        mass: kg.
        stiffness: N/m.
        temperature: °C.
    """

    mass: float
    stiffness: float
    temperature: float


def law(kind: str, setting: float) -> Law:
    """A controller, from the paper's equations.

    Args:
        kind: "P", "PID", "GS", "OO" or "passive".
        setting: D, N·s/m, or a current, A.
    """
    if kind == "PID":
        return pid_law(setting)
    currents = np.linspace(0.0, LARGEST, 6)
    table = [numbers(i, 15.0) for i in currents]
    forces = np.array([0.25 * post + yielding for post, yielding, _ in table])

    def chosen(body: float, rate: float, force: float) -> float:
        if kind == "passive":
            return setting
        if body * rate > 0.0:
            return 0.0
        if kind == "OO":
            return setting
        sign = np.sign(rate)
        wanted = -setting * body * sign
        if kind == "GS":
            return float(np.interp(wanted, forces, currents))
        return float(0.0012 * (wanted - 0.6 * force * sign))

    return chosen


def pid_law(setting: float) -> Law:
    """A PID controller, asked once a sample in the order of time.

    Args:
        setting: D, N·s/m.
    """
    before: list[tuple[float, bool]] = []
    area = 0.0

    def chosen(body: float, rate: float, force: float) -> float:
        nonlocal area
        error, on = float(-setting * body - force) * float(np.sign(rate)), body * rate <= 0.0
        kept = bool(before) and before[-1][1] == on
        change = error - before[-1][0] if kept else 0.0
        area = area + 0.5 * PERIOD * (error + before[-1][0]) if kept else 0.0
        before.append((error, on))
        return 5e-4 * error + 0.2 * area + 3.13e-7 * change / PERIOD if on else 0.0

    return chosen


def sampled_run(
    isolator: Isolator,
    control: Law,
    base: CubicSpline,
    period: float,
    samples: int,
    **options: Any,
) -> np.ndarray:
    """State x_m, ẋ_m, u, w, i at every sample of a controller that holds its current.

    Returns:
        [samples, 5].
    """  # fmt: skip
    rates, k = _rates(isolator, base)
    state, rows = np.zeros(5), []
    chosen: dict[str, Any] = {"method": "Radau", "rtol": 1e-9, "atol": 1e-12, **options}
    speed = base.derivative()
    for n in range(samples):
        t = n * period
        rows.append(state)
        rate = float(speed(t)) - state[1]
        command = min(max(control(state[1], rate, k * state[2]), 0.0), LARGEST)
        ran = solve_ivp(
            lambda t, z, command=command: rates(t, z, command), (t, t + period), state, **chosen
        )
        state = ran.y[:, -1]
    return np.array(rows)


def continuous_run(
    isolator: Isolator, control: Law, base: CubicSpline, time: np.ndarray, **options: Any
) -> np.ndarray:
    """The same with a controller that never waits: one call of `solve_ivp`, [time, 5]."""
    rates, k = _rates(isolator, base)
    speed = base.derivative()

    def closed(t: float, z: np.ndarray) -> tuple[float, ...]:
        rate = float(speed(t)) - z[1]
        return rates(t, z, min(max(control(z[1], rate, k * z[2]), 0.0), LARGEST))

    chosen: dict[str, Any] = {"method": "LSODA", "rtol": 1e-5, "atol": 1e-8, **options}
    return solve_ivp(closed, (time[0], time[-1]), np.zeros(5), t_eval=time, **chosen).y.T


def _rates(
    isolator: Isolator, base: CubicSpline
) -> tuple[Callable[[float, np.ndarray, float], tuple[float, ...]], float]:
    knots = np.linspace(0.0, LARGEST, 6)
    table = np.array([numbers(i, isolator.temperature) for i in knots])
    k, speed = float(table[0, 2]), base.derivative()
    mass, stiffness = isolator.mass, isolator.stiffness

    def rates(t: float, z: np.ndarray, command: float) -> tuple[float, ...]:
        x, v, u, w, i = z.tolist()
        place = min(max(5.0 * i, 0.0), 5.0)
        j = min(int(place), 4)
        post, yielding = (table[j] + (place - j) * (table[j + 1] - table[j]))[:2].tolist()
        clipped = min(max((C_PRE - post) * w, -yielding), yielding)
        return (
            v,
            (stiffness * (float(base(t)) - x) + k * u) / mass,
            float(speed(t)) - v - w,
            (k * u - post * w - clipped) / FLUID_MASS,
            (command - i) / LAG,
        )

    return rates, k
