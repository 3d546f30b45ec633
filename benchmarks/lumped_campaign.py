"""Loops of the lumped model as a campaign has them: clean, or with noise and errors of a rig."""

from collections.abc import Callable
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np
from sine_loops import sine_loops

from sysid.data.loops import Loops
from sysid.models.lumped import TABLE_1, Lumped
from sysid.models.simulate import simulate
from sysid.motion.motion import sine_motion
from sysid.parameters import build
from sysid.rig.planters.periodic import through

CURRENTS: Final = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
"""A, of Table 1."""
EXCITATIONS: Final = ((0.010, 8.0), (0.005, 4.0))
"""m, Hz."""
COLD_TO_HOT: Final = (11.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 55.0, 60.0, 67.0, 75.0)
"""°C, of a sweep."""


class Truth(NamedTuple):
    """The element's numbers at each test, [L]."""

    viscosity: np.ndarray
    yield_force: np.ndarray
    stiffness: np.ndarray


class Conditions(NamedTuple):
    """Of each test, [L]: m, Hz, A, °C."""

    amplitude: np.ndarray
    frequency: np.ndarray
    current: np.ndarray
    temperature: np.ndarray


def sweep(currents: tuple[float, ...], temperatures: tuple[float, ...]) -> Conditions:
    """Both excitations at every current and temperature."""
    rows = [(a, f, i, t) for a, f in EXCITATIONS for i in currents for t in temperatures]
    return Conditions(*np.array(rows).T)


def table_1() -> Lumped:
    """The model with the paper's numbers."""
    return build(Lumped, TABLE_1)


def truth_at(tests: Conditions) -> Truth:
    """What the model has at the conditions of each test."""
    element = table_1().element(sine_motion(*tests, points=4))
    numbers = (element.post, element.yielding, element.stiffness)
    return Truth(*(np.asarray(z)[:, 0] for z in numbers))


def names(tests: Conditions) -> tuple[str, ...]:
    """Ids of the tests."""
    rows = zip(*(z.tolist() for z in tests), strict=True)
    return tuple(f"{1e3 * a:g}mm_{f:g}Hz_{i:g}A_{t:g}C" for a, f, i, t in rows)


def clean_loops(tests: Conditions, points: int = 360) -> tuple[Loops, Truth]:
    """Steady loops free of noise, and what they were made with."""
    motion = sine_motion(*tests, points=points)
    force = np.array(simulate(table_1(), motion))
    loops = sine_loops(names(tests), motion, force, tests, noise_floor=0.0)
    return loops, truth_at(tests)


def noisy_loops(
    tests: Conditions,
    rng: np.random.Generator,
    *,
    noise: float = 0.01,
    offset: float = 2.0,
    temperature: float = 0.3,
    cycles: int = 10,
    gain: float = 0.0,
    delay: float = 0.0,
    made: Callable[[Conditions], Loops] | None = None,
) -> tuple[Loops, Truth]:
    """A campaign as a rig would give it.

    Args:
        tests: As they were meant; the loops carry these temperatures.
        rng: Source of all errors.
        noise: Of a cycle, in parts of each test's max|F|, white along it.
        offset: N, of the load cell, anew in each test.
        temperature: K, between what the thermocouple says and what the damper had.
        cycles: Of each test.
        gain: Relative error of the load cell, anew in each test.
        delay: s, of force after displacement, anew in each test.
        made: Clean loops of another damper than the paper's.

    Returns:
        Loops, and the truth at the temperatures that they carry.
    """
    count = tests.current.size
    felt = tests._replace(temperature=tests.temperature + temperature * rng.standard_normal(count))
    loops = clean_loops(felt)[0] if made is None else made(felt)
    points = loops.force.shape[1]
    force = loops.force
    if delay:
        by = delay * rng.standard_normal((count, 1))
        force = through(force, loops.frequency, lambda w: np.exp(-1j * w * by))
    if gain:
        force = force * (1.0 + gain * rng.standard_normal((count, 1)))
    sd = noise * np.abs(loops.force).max(axis=1)
    errors = rng.standard_normal((count, cycles, points)) * sd[:, None, None]
    mean = errors.mean(axis=1)
    told = replace(
        loops,
        ids=names(tests),
        temperature=tests.temperature,
        force=force + mean + offset * rng.standard_normal((count, 1)),
        cycles=np.full(count, cycles, dtype=np.int64),
        noise_floor=sd,
        deviations=tuple(errors - mean[:, None, :]),
        displacement_deviations=tuple(np.zeros((count, cycles, points))),
    )
    return told, truth_at(tests)
