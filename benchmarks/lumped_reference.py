"""The lumped model's equation as SciPy solves it, written apart from the model."""

from collections.abc import Callable
from math import cos
from typing import Any, Final

import numpy as np
from scipy.integrate import solve_ivp

TABLE: Final[dict[float, tuple[float, float, float, float]]] = {
    0.0: (1400.0, -6.78, 41.0, 0.19),
    0.2: (1265.0, -7.07, 331.0, -0.53),
    0.4: (1451.0, -8.11, 766.0, -1.87),
    0.6: (1616.0, -8.74, 1178.0, -3.47),
    0.8: (1734.0, -8.91, 1481.0, -5.26),
    1.0: (1824.0, -9.43, 1667.0, -6.42),
}
"""BS09 Table 1: A → C_post at 0 °C and its change per kelvin, F_y at 0 °C and its change."""
CURRENTS: Final = tuple(TABLE)
TEMPERATURES: Final = (15.0, 45.0, 75.0)
EXCITATIONS: Final = ((0.010, 8.0), (0.005, 4.0))
"""m, Hz."""
C_PRE: Final = 1.0e5
MASS: Final = 2.0

Law = Callable[[float], float]


def numbers(current: float, temperature: float) -> tuple[float, float, float]:
    """C_post, F_y and k, straight in current between those of the table."""
    rows = np.array(list(TABLE.values()))
    a, b, c, d = (float(np.interp(current, CURRENTS, column)) for column in rows.T)
    return a + b * temperature, c + d * temperature, 1e3 * (1500.0 + 150.0 * temperature)


def force_in_time(
    time: np.ndarray, velocity: Law, current: Law, temperature: Law, **options: Any
) -> np.ndarray:
    """Force at given times, from rest at the first, by SciPy's Radau.

    Args:
        time: [n] s.
        velocity: s → m/s.
        current: s → A, what the fluid feels.
        temperature: s → °C.
        options: Of `solve_ivp`.
    """

    def rates(t: float, z: np.ndarray) -> tuple[float, float]:
        post, yielding, k = numbers(current(t), temperature(t))
        clipped = min(max((C_PRE - post) * z[1], -yielding), yielding)
        return velocity(t) - z[1], (k * z[0] - post * z[1] - clipped) / MASS

    chosen: dict[str, Any] = {"method": "Radau", "rtol": 1e-8, "atol": 1e-12, **options}
    ran = solve_ivp(rates, (time[0], time[-1]), (0.0, 0.0), t_eval=time, **chosen)
    k = np.array([numbers(current(t), temperature(t))[2] for t in time])
    return k * ran.y[0]


def steady_force(
    amplitude: float,
    frequency: float,
    current: float,
    temperature: float,
    points: int,
    *,
    cycles: int = 2,
    **options: Any,
) -> np.ndarray:
    """Last of some cycles of a sine wave, [points], phase 2πj/points.

    Args:
        amplitude: m.
        frequency: Hz.
        current: A.
        temperature: °C.
        points: A cycle.
        cycles: How many are run; the state of a damper that yields has forgotten its start
            after one.
        options: Of `solve_ivp`; Radau at a tolerance of 1e-8 unless told otherwise.
    """
    omega, peak = 2.0 * np.pi * frequency, 2.0 * np.pi * frequency * amplitude
    post, yielding, k = numbers(current, temperature)
    beyond, limit = C_PRE - post, yielding / (C_PRE - post)

    def rates(t: float, z: np.ndarray) -> tuple[float, float]:
        u, w = z.tolist()
        clipped = limit if w > limit else -limit if w < -limit else w
        return peak * cos(omega * t) - w, (k * u - post * w - beyond * clipped) / MASS

    def slopes(t: float, z: np.ndarray) -> np.ndarray:
        damping = C_PRE if abs(z[1]) < limit else post
        return np.array([[0.0, -1.0], [k / MASS, -damping / MASS]])

    time = (np.arange(points) / points + cycles - 1) / frequency
    start = ((post * peak + yielding) / k, peak)
    chosen: dict[str, Any] = {
        "method": "Radau", "rtol": 1e-8, "atol": 1e-12, "jac": slopes, **options,
    }  # fmt: skip
    ran = solve_ivp(rates, (0.0, time[-1]), start, t_eval=time, **chosen)
    return k * ran.y[0]
