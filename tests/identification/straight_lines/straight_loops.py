"""Loops made of straight lines, on which the recipes must be exact."""

from dataclasses import replace

import numpy as np

from sysid.data.loops import Loops
from tests.data.loop_of import loops_of

FAST, SLOW = (0.010, 8.0), (0.005, 4.0)


def straight_force(
    excitation: tuple[float, float],
    viscosity: float,
    yield_force: float,
    stiffness: float,
    offset: float = 0.0,
    points: int = 720,
) -> np.ndarray:
    """Force falls along k after each reversal until the line F_y + C_post v of the other side."""
    a, f = excitation
    phase = 2.0 * np.pi * np.arange(points) / points
    x, v = a * np.sin(phase), 2.0 * np.pi * f * a * np.cos(phase)
    # v is 1e-17 where it should be zero
    side = np.where((phase < np.pi / 2) | (phase >= 3 * np.pi / 2), 1.0, -1.0)
    beyond = side * yield_force + viscosity * v
    spring = -side * yield_force + side * stiffness * (a + side * x)
    return offset + side * np.minimum(side * spring, side * beyond)


def sweep_loops(
    currents: tuple[float, ...] = (0.0, 0.8, 1.0),
    temperatures: tuple[float, ...] = (15.0, 30.0, 45.0, 60.0, 75.0),
    excitations: tuple[tuple[float, float], ...] = (FAST, SLOW),
    offset: float = 25.0,
) -> Loops:
    """A sweep whose C_post, F_y and k are `laws`."""
    rows = [(e, i, t) for e in excitations for i in currents for t in temperatures]
    force = np.array([straight_force(e, *laws(i, t), offset) for e, i, t in rows])
    a, f = np.array([e for e, _, _ in rows]).T
    loops = loops_of(force, a, f, np.array([i for _, i, _ in rows]))
    return replace(loops, temperature=np.array([t for _, _, t in rows]))


def laws(current: float, temperature: float) -> tuple[float, float, float]:
    """C_post, F_y and k, straight in temperature."""
    return (
        1400.0 + 400.0 * current - 8.0 * temperature,
        200.0 + 1400.0 * current - 5.0 * current * temperature,
        1.5e6 + 1.5e5 * temperature,
    )


def with_noise(
    loops: Loops, rng: np.random.Generator, sd: float, cycles: int, memory: float = 0.0
) -> Loops:
    """Noise on every cycle, in which neighbouring points remember each other.

    Args:
        loops: Free of noise.
        rng: Source.
        sd: N, at every point of a cycle.
        cycles: Number.
        memory: Correlation of neighbours.
    """
    count, points = loops.force.shape
    white = rng.standard_normal((count, cycles, points))
    frequency = 2.0 * np.pi * np.fft.rfftfreq(points)
    shape = 1.0 / np.abs(1.0 - memory * np.exp(-1j * frequency))
    noise = np.fft.irfft(np.fft.rfft(white) * shape, points)
    noise *= sd / noise.std()
    mean = noise.mean(axis=1)
    return replace(
        loops,
        force=loops.force + mean,
        cycles=np.full(count, cycles, dtype=np.int64),
        deviations=tuple(noise - mean[:, None]),
        displacement_deviations=tuple(np.zeros((count, cycles, points))),
    )
