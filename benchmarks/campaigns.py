"""Random campaigns whose truth is known: the published tables, jittered, on W11's test matrix."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from sine_loops import sine_loops

from sysid.data.loops import Loops
from sysid.models.generalized import ASYMMETRIC, HIGH_SYMMETRIC, LOW_SYMMETRIC, Generalized
from sysid.motion.motion import sine_motion
from sysid.parameters import build

TABLES: Final = {"low": LOW_SYMMETRIC, "high": HIGH_SYMMETRIC, "asymmetric": ASYMMETRIC}

MATRIX: Final = {
    2.5e-3: (0.1, 0.5, 1.5, 2.5, 5.0, 7.5, 10.0, 12.5, 15.0),
    12.5e-3: (0.1, 0.5, 1.5, 2.5, 5.0, 7.5, 10.0, 12.5),
    25e-3: (0.1, 0.5, 1.5, 2.5, 5.0, 7.5, 10.0),
    50e-3: (0.1, 0.5, 1.5, 2.5, 5.0),
    75e-3: (0.1, 0.5, 1.5, 2.5),
}
"""Amplitude, m → frequencies, Hz: the 33 conditions of W11 Table 1."""

CURRENTS: Final = (0.0, 0.1, 0.2, 0.3, 0.4)
FASTEST: Final = 0.4
"""m/s: beyond it the tables are extrapolations (F_t grows as exp(a_1 v_m))."""
JITTER: Final = 0.3
NOISE: Final = 0.01


@dataclass(frozen=True)
class Campaign:
    """One random campaign.

    Attributes:
        table: Which published table it was drawn about.
        truth: Symbol → value.
        loops: What was measured, noise included.
    """

    table: str
    truth: dict[str, float]
    loops: Loops

    @property
    def symmetric(self) -> bool:
        """The truth has k_1e = k_1c and k_5 = k_6 = 0."""
        return self.table != "asymmetric"


def table_one() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(amplitude m, frequency Hz, current A) of the 110 loops with v_m ≤ 0.4 m/s, [110] each."""
    rows = [
        (amplitude, frequency, current)
        for amplitude, frequencies in MATRIX.items()
        for frequency in frequencies
        if 2.0 * np.pi * amplitude * frequency <= FASTEST
        for current in CURRENTS
    ]
    amplitude, frequency, current = np.array(rows).T
    return amplitude, frequency, current


def random_conditions(
    count: int, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As `table_one`, with `count` tests on conditions drawn evenly in log A and log f."""
    conditions = -(-count // len(CURRENTS))
    kept: list[tuple[float, float]] = []
    while len(kept) < conditions:
        amplitude = float(np.exp(rng.uniform(np.log(2.5e-3), np.log(75e-3))))
        frequency = float(np.exp(rng.uniform(np.log(0.1), np.log(15.0))))
        if 2.0 * np.pi * amplitude * frequency <= FASTEST:
            kept.append((amplitude, frequency))
    pairs = np.repeat(np.array(kept), len(CURRENTS), axis=0)[:count]
    return pairs[:, 0], pairs[:, 1], np.tile(CURRENTS, conditions)[:count]


def draw_truth(table: str, rng: np.random.Generator) -> dict[str, float]:
    """A published table with every parameter multiplied by 1 ± 30 %, evenly; symmetry is kept."""
    truth = {s: v * (1.0 + rng.uniform(-JITTER, JITTER)) for s, v in TABLES[table].items()}
    if table != "asymmetric":
        truth["k_1e"] = truth["k_1c"]
    return truth


def draw_campaign(
    seed: int,
    *,
    table: str | None = None,
    conditions: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None,
    noise: float = NOISE,
) -> Campaign:
    """One campaign of steady sine loops of 360 points.

    Args:
        seed: Everything random follows from it.
        table: Name in `TABLES`; drawn if None.
        conditions: As from `table_one`, which is the default.
        noise: White noise per sample, parts of each test's RMS force.
    """
    rng = np.random.default_rng([20_110_000, seed])
    table = table or str(rng.choice(list(TABLES)))
    truth = draw_truth(table, rng)
    amplitude, frequency, current = conditions or table_one()
    motion = sine_motion(amplitude, frequency, current)
    force = np.array(build(Generalized, truth).force(motion))
    rms = np.sqrt(np.mean(force**2, axis=1, keepdims=True))
    force += noise * rms * rng.standard_normal(force.shape)
    ids = [f"test-{k:05d}" for k in range(len(force))]
    loops = sine_loops(ids, motion, force, (amplitude, frequency, current, None))
    return Campaign(table, truth, loops)
