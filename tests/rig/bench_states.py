"""A test on the bench as planters get it, and valves that give closed forms."""

import numpy as np

from sysid.models.generalized import LOW_SYMMETRIC
from sysid.rig.planters.bench_state import BenchState, steady_bench
from sysid.rig.planters.valve import HystereticValve

PHASE = 2.0 * np.pi * np.arange(720) / 720


class Dashpot:
    """F = c v: with it everything in series has a closed form."""

    memoryless = True

    def __init__(self, viscosity: float):
        self.viscosity = viscosity

    def force(self, velocity, side, peak_velocity, current):
        return self.viscosity * velocity


class Signal:
    """A given force at every point, whatever the motion."""

    memoryless = False

    def __init__(self, shape):
        self.shape = shape

    def force(self, velocity, side, peak_velocity, current):
        return np.broadcast_to(self.shape, velocity.shape).copy()


def one(
    amplitude: float, frequency: float, current: float = 0.2, valve=None, points: int = 720
) -> BenchState:
    return steady_bench(
        HystereticValve(LOW_SYMMETRIC) if valve is None else valve,
        np.array([amplitude]),
        np.array([frequency]),
        np.array([current]),
        points=points,
    )


def added(planter, state: BenchState) -> np.ndarray:
    return (planter.plant(state).force - state.force)[0]
