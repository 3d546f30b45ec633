"""Whole tests of a physical damper, many at once: from rest through ramps and cycles to rest."""

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Any, Final

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float

from sysid.rig.excitation import SineRun
from sysid.rig.physical.automotive import AUTOMOTIVE
from sysid.rig.physical.damper import PhysicalDamper
from sysid.rig.physical.equations import Drive, Seen, at_rest, balance, unpack
from sysid.rig.physical.grid import RESTING, graded_turns, resting_share
from sysid.rig.physical.solver import GAMMA, TOLERANCE, integrate

PerTest = Float[np.ndarray, " test"]
Grid = Float[np.ndarray, "step test"]

POINTS: Final = 1600
"""Steps a cycle; docs/physical-damper.md has the error that they leave."""
WORKERS: Final = 2
"""Threads that share the tests."""


@dataclass(frozen=True)
class Outset:
    """How tests begin, one number for each.

    Attributes:
        yield_stress: Of the fluid under the poles in the test's field, at 40 °C, Pa.
        coil_power: Heat of the coil, W.
        oil: °C.
        body: And of gas and thermocouple, °C.
    """

    yield_stress: PerTest
    coil_power: PerTest
    oil: PerTest
    body: PerTest


@dataclass(frozen=True)
class Courses:
    """What happened, SI and °C, in columns of tests.

    Attributes:
        time: From the start of the motion, s.
        force: On the load cell, N.
        ram: Position of the ram, m.
        speed: Of the piston, m/s.
        far: Absolute pressure in the chamber without rod.
        near: The same in the rod's.
        foam: Free gas that came out, share at atmospheric pressure.
        friction: Of the rod's seal.
        heat: Set free by friction, W.
        gas_heat: Power from the gas to the body, W.
        oil: °C.
        body: °C.
    """

    time: Grid
    force: Grid
    ram: Grid
    speed: Grid
    far: Grid
    near: Grid
    foam: Grid
    friction: Grid
    heat: Grid
    gas_heat: Grid
    oil: Grid
    body: Grid


def run_tests(
    damper: PhysicalDamper, runs: Sequence[SineRun], outset: Outset, points: int = POINTS
) -> Courses:
    """Run tests that have the same number of cycles.

    Args:
        damper: All constants; each is a number, or one for each test.
        runs: True commands to the actuator.
        outset: State at the start.
        points: Steps a cycle.

    Raises:
        ArithmeticError: Newton's iteration did not end.
    """
    turns = graded_turns(runs[0].ramp_up + runs[0].steady + runs[0].ramp_down, points)
    count = len(runs)
    parts = min(WORKERS, count)
    size = math.ceil(count / parts)
    chosen = [np.minimum(np.arange(k * size, (k + 1) * size), count - 1) for k in range(parts)]
    solve = _compiled(size, len(turns) + RESTING - 1)
    with ThreadPoolExecutor(parts) as pool:
        done = list(
            pool.map(lambda which: _run_part(solve, damper, runs, outset, turns, which), chosen)
        )
    joined = {
        f.name: np.concatenate([getattr(part, f.name) for part in done], axis=1)[:, :count]
        for f in fields(Courses)
    }
    return Courses(**joined)


@lru_cache(maxsize=4)
def _compiled(tests: int, steps: int) -> Callable[..., Any]:
    """`_solve` for a number of tests and steps, compiled once for all threads."""

    def array(*shape: int) -> jax.ShapeDtypeStruct:
        return jax.ShapeDtypeStruct(shape, jnp.float64)

    damper = jax.tree.map(lambda _: array(tests), AUTOMOTIVE)
    drive = array(steps, len(Drive._fields), tests)
    state = (array(tests), array(tests), array(tests))
    return jax.jit(_solve).lower(damper, *state, (drive, drive), array(steps, tests)).compile()


def _run_part(
    solve: Callable[..., Any],
    damper: PhysicalDamper,
    runs: Sequence[SineRun],
    outset: Outset,
    turns: Float[np.ndarray, " step"],
    which: np.ndarray,
) -> Courses:
    """Some of the tests."""
    chosen = [runs[k] for k in which]
    of_test = jax.tree.map(
        lambda leaf: jnp.broadcast_to(jnp.asarray(leaf, float), len(runs))[which], damper
    )
    start = Outset(*(getattr(outset, f.name)[which] for f in fields(Outset)))
    frequency = np.array([run.frequency for run in chosen])
    rest = np.array([run.rest for run in chosen])
    time = np.concatenate(
        [turns[:, None] / frequency, turns[-1] / frequency + resting_share() * rest]
    )
    steps = np.diff(time, axis=0)
    stages = (time[:-1] + GAMMA * steps, time[1:])
    drives = tuple(jnp.asarray(_drive(chosen, at, start)) for at in stages)
    centre = jnp.asarray([run.centre for run in chosen])
    ys, worst, seen = solve(
        of_test, centre, jnp.asarray(start.oil), jnp.asarray(start.body), drives, jnp.asarray(steps)
    )
    if not float(worst) <= TOLERANCE:
        raise ArithmeticError(
            f"a step of the physical damper was not solved: {float(worst):g} left"
        )
    state = unpack(ys)
    columns = (
        seen.force, seen.ram, state.speed, *seen.pressures[:2], state.foam,
        seen.friction, seen.heat, seen.gas_heat, seen.oil, seen.body,
    )  # fmt: skip
    return Courses(time, *(np.asarray(column) for column in columns))


def _drive(runs: Sequence[SineRun], time: Grid, start: Outset) -> Float[np.ndarray, "step 4 test"]:
    """What is done to each test at the times of one stage."""
    states = [run.state(time[:, k] + run.rest) for k, run in enumerate(runs)]
    command = np.stack([state.displacement for state in states], axis=1)
    speed = np.stack([state.velocity for state in states], axis=1)
    constant = (np.broadcast_to(x, time.shape) for x in (start.yield_stress, start.coil_power))
    return np.stack([command, speed, *constant], axis=1)


def _solve(
    damper: PhysicalDamper,
    centre: Array,
    oil: Array,
    body: Array,
    drives: tuple[Array, Array],
    steps: Array,
) -> tuple[Array, Array, Seen]:
    """Y [13, step, test] with the start as first, Newton's last change, what is seen."""
    start = at_rest(damper, centre, oil, body)
    ys, _, worst = integrate(
        lambda y, drive: balance(damper, y, Drive(*drive))[:2], start, drives, steps
    )
    ys = jnp.concatenate([start[None], ys])
    last = jnp.concatenate([drives[0][:1], drives[1]])
    turned = jnp.moveaxis(ys, 1, 0)
    return turned, worst, balance(damper, turned, Drive(*jnp.moveaxis(last, 1, 0)))[2]
