"""Dampers as they leave the end of a line: each its own, scattered about the design of its type."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from campaigns import CURRENTS, NOISE, TABLES, draw_truth
from sine_loops import sine_loops

from sysid.data.loops import Loops
from sysid.models.generalized import Generalized
from sysid.motion.motion import sine_motion
from sysid.parameters import build

PLAN: Final = ((2.5e-3, 5.0), (12.5e-3, 0.5), (12.5e-3, 2.5), (25e-3, 2.5))
"""Amplitude, m, and frequency, Hz; v_m from 0.04 to 0.39 m/s."""
POINTS: Final = 72
DESIGNS: Final = 10
END_OF_LINE, WIDE = 0.2, 0.5
"""Even scatter of every parameter about its design."""
SETTING: Final = 0.01
"""Standard deviation of the amplitude that the rig reaches."""


@dataclass(frozen=True)
class Damper:
    """One damper of a fleet.

    Attributes:
        design: Number of its type.
        truth: Symbol → value.
        loops: Its 20 loops.
    """

    design: int
    truth: dict[str, float]
    loops: Loops


def draw_designs() -> list[dict[str, float]]:
    """The three published sets, and seven drawn within ±30 % of one of them."""
    rng = np.random.default_rng(20_260_000)
    names = list(TABLES)
    drawn = [draw_truth(names[k % 3], rng) for k in range(DESIGNS - 3)]
    return [dict(table) for table in TABLES.values()] + drawn


def draw_dampers(count: int, scatter: float, *, first: int = 0) -> list[Damper]:
    """Dampers of all designs in turn; each follows from its number alone.

    Args:
        count: How many.
        scatter: Parameters are even within 1 ± this about the design.
        first: Number of the first.
    """
    designs = draw_designs()
    return [_damper(k, designs[k % DESIGNS], scatter) for k in range(first, first + count)]


def _damper(number: int, design: dict[str, float], scatter: float) -> Damper:
    rng = np.random.default_rng([20_260_001, number, round(1000 * scatter)])
    truth = {s: v * (1.0 + rng.uniform(-scatter, scatter)) for s, v in design.items()}
    if design["k_1e"] == design["k_1c"]:
        truth["k_1e"] = truth["k_1c"]
    tests = np.array([(a, f, i) for a, f in PLAN for i in CURRENTS])
    amplitude, frequency, current = tests.T
    amplitude = amplitude * (1.0 + SETTING * rng.standard_normal(len(tests)))
    motion = sine_motion(amplitude, frequency, current, points=POINTS)
    force = np.array(build(Generalized, truth).force(motion))
    rms = np.sqrt(np.mean(force**2, axis=1, keepdims=True))
    force += NOISE * rms * rng.standard_normal(force.shape)
    ids = [f"test-{k:02d}" for k in range(len(tests))]
    loops = sine_loops(ids, motion, force, (amplitude, frequency, current, None))
    return Damper(number % DESIGNS, truth, loops)
