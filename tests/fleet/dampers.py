"""A few dampers with loops of 72 points, for tests of batched fits."""

import numpy as np

from sysid.data.loops import Loops
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.motion.motion import sine_motion
from sysid.parameters import build

POINTS = 72
TESTS = np.array([
    (a, f, i) for a, f in ((0.0125, 0.5), (0.0125, 2.5), (0.025, 2.5)) for i in (0.0, 0.2, 0.4)
])  # fmt: skip


def damper(number, tests=TESTS, points=POINTS, noise=0.01, **changed):
    """Loops of the published low set, each parameter within ±20 %, as `number` says."""
    rng = np.random.default_rng(number)
    truth = {s: v * (1.0 + rng.uniform(-0.2, 0.2)) for s, v in LOW_SYMMETRIC.items()}
    truth |= {"k_1e": truth["k_1c"], "k_5": 0.1, "k_6": 0.1} | changed
    amplitude, frequency, current = np.asarray(tests).T
    motion = sine_motion(amplitude, frequency, current, points=points)
    force = np.array(build(Generalized, truth).force(motion))
    rms = np.sqrt(np.mean(force**2, axis=1, keepdims=True))
    force += noise * rms * rng.standard_normal(force.shape)
    count = len(force)
    none = (np.empty((0, points)),) * count
    return Loops(
        ids=tuple(f"test-{k}" for k in range(count)),
        displacement=np.asarray(motion.displacement),
        velocity=np.asarray(motion.velocity),
        acceleration=np.asarray(motion.acceleration),
        force=force,
        amplitude=amplitude,
        frequency=frequency,
        current=current,
        temperature=np.full(count, 40.0),
        centre=np.zeros(count),
        cycles=np.ones(count, dtype=int),
        noise_floor=np.full(count, 1.0),
        deviations=none,
        displacement_deviations=none,
        harmonics=np.eye(1, 15)[0] * amplitude[:, None].astype(complex),
    )
