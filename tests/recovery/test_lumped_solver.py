"""The lumped model against SciPy: a slice of the paper's loops, and a motion of any shape."""

import numpy as np
import pytest
from lumped_reference import force_in_time
from lumped_solver import ALLOWED, conditions, errors, reference

from sysid.models.lumped import TABLE_1, Lumped
from sysid.models.simulate import simulate
from sysid.motion.motion import Motion, sine_motion
from sysid.motion.time_motion import time_motion
from sysid.parameters import build

VALVE = build(Lumped, TABLE_1)


@pytest.fixture(scope="module")
def slice_of_the_loops() -> tuple[tuple[np.ndarray, ...], np.ndarray]:
    """0 and 1 A, 15 and 75 °C, both excitations."""
    loops = conditions(2)
    kept = loops[3] != 45.0
    chosen = tuple(row[kept] for row in loops)
    return chosen, reference(chosen)


@pytest.mark.parametrize(("points", "allowed"), [(24, 2 * ALLOWED), (72, 0.1 * ALLOWED)])
def test_steady_loops_meet_a_stiff_solver(slice_of_the_loops, points, allowed):
    loops, exact = slice_of_the_loops
    force = np.asarray(simulate(VALVE, sine_motion(*loops, points=points)))
    assert errors(force, exact).max() < allowed


DURATION = 0.5


def displacement(t: np.ndarray) -> np.ndarray:
    return 0.006 * np.sin(2 * np.pi * 3.0 * t) + 0.002 * np.sin(2 * np.pi * 11.0 * t)


def velocity(t: np.ndarray) -> np.ndarray:
    slow = 0.036 * np.pi * np.cos(6 * np.pi * t)
    return slow + 0.044 * np.pi * np.cos(22 * np.pi * t)


def felt(t: np.ndarray) -> np.ndarray:
    """Current behind a lag of 3 ms of 0.5 A + 0.3 A sin(2π 6 Hz t) since ever."""
    turn = 0.3 / (1 + 0.003j * 12 * np.pi) * np.exp(12j * np.pi * t)
    return 0.5 + turn.imag


def temperature(t: np.ndarray) -> np.ndarray:
    return 20.0 + 40.0 * t


def on_grid(samples: int) -> Motion:
    t = np.linspace(0.0, DURATION, samples)
    v = velocity(t)
    return time_motion(
        t,
        displacement(t),
        velocity=v,
        acceleration=np.gradient(v, t),
        current=0.5 + 0.3 * np.sin(12 * np.pi * t),
        temperature=temperature(t),
    )


def test_any_motion_with_current_and_temperature_that_change_is_of_second_order():
    """After the first 40 ms, in which the lag of the current comes from rest."""
    t = np.linspace(0.0, DURATION, 251)
    exact = force_in_time(t, velocity, felt, temperature, rtol=1e-7, atol=1e-11)
    kept, found = t > 0.04, []
    for finer in (1, 2, 4):
        force = np.asarray(simulate(VALVE, on_grid(250 * finer + 1)))[::finer]
        found.append(np.abs(force - exact)[kept].max() / np.abs(exact).max())
    assert found[2] < ALLOWED
    assert found[0] > 3 * found[1] > 9 * found[2]
