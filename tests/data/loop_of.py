"""Loops of pure sinusoids with any force, without cutting."""

import numpy as np

from sysid.data.loops import Loops


def loops_of(
    force: np.ndarray, amplitude: np.ndarray, frequency: np.ndarray, current: np.ndarray
) -> Loops:
    """Stack forces [L, J] on x = A sin φ."""
    count, points = force.shape
    phase = 2.0 * np.pi * np.arange(points) / points
    a, w = amplitude[:, None], 2.0 * np.pi * frequency[:, None]
    harmonics = np.zeros((count, 15), dtype=np.complex128)
    harmonics[:, 0] = amplitude
    nan = np.full(count, np.nan)
    return Loops(
        ids=tuple(f"test{k}" for k in range(count)),
        displacement=a * np.sin(phase),
        velocity=a * w * np.cos(phase),
        acceleration=-a * w**2 * np.sin(phase),
        force=force,
        amplitude=amplitude,
        frequency=frequency,
        current=current,
        temperature=nan,
        centre=np.zeros(count),
        cycles=np.ones(count, dtype=np.int64),
        noise_floor=nan,
        deviations=tuple(np.zeros((1, points)) for _ in range(count)),
        displacement_deviations=tuple(np.zeros((1, points)) for _ in range(count)),
        harmonics=harmonics,
    )
