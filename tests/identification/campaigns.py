"""Loops of known models, for tests of the fit."""

import numpy as np

from sysid.data.loops import Loops
from sysid.models.generalized import Generalized
from sysid.motion.motion import sine_motion
from sysid.parameters import build


def virtual_loops(table, conditions, currents, noise=0.0, seed=0, cycles=4):
    """Loops of a table at (amplitude m, frequency Hz) × currents; noise relative to each RMS."""
    grid = np.array([(a, f, i) for a, f in conditions for i in currents])
    amplitude, frequency, current = grid.T
    motion = sine_motion(amplitude, frequency, current)
    force = np.asarray(build(Generalized, table).force(motion))
    rms = np.sqrt(np.mean(force**2, axis=1, keepdims=True))
    rng = np.random.default_rng(seed)
    scatter = [
        noise * rms[k] * rng.standard_normal((cycles, force.shape[1])) for k in range(len(grid))
    ]
    mean = np.stack([s.mean(axis=0) for s in scatter])
    n = len(grid)
    return Loops(
        ids=tuple(f"{1e3 * a:g}mm_{f:g}Hz_{i:g}A" for a, f, i in grid),
        displacement=np.asarray(motion.displacement),
        velocity=np.asarray(motion.velocity),
        acceleration=np.asarray(motion.acceleration),
        force=force + mean,
        amplitude=amplitude,
        frequency=frequency,
        current=current,
        temperature=np.full(n, 40.0),
        centre=np.zeros(n),
        cycles=np.full(n, cycles),
        noise_floor=noise * rms[:, 0] if noise else np.full(n, np.nan),
        deviations=tuple(s - m for s, m in zip(scatter, mean, strict=True)),
        displacement_deviations=tuple(np.zeros((cycles, force.shape[1])) for _ in range(n)),
        harmonics=np.eye(1, 15)[0] * amplitude[:, None].astype(complex),
    )


LOW_DESIGN = [(0.0125, f) for f in (0.5, 1.5, 2.5, 5.0)]
HIGH_DESIGN = [(0.0025, f) for f in (5.0, 7.5, 10.0, 12.5, 15.0)]
ASYMMETRIC_DESIGN = [(a, f) for a in (0.0125, 0.025) for f in (0.5, 1.5)]
FIVE_CURRENTS = (0.0, 0.1, 0.2, 0.3, 0.4)
