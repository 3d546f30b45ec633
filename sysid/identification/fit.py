"""Entry point: from loops to a fitted model."""

from collections.abc import Callable, Mapping
from typing import Final

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from sysid.data.loops import Loops
from sysid.errors import FitError
from sysid.identification.families import family
from sysid.identification.features import loop_features
from sysid.identification.multistart import find_minimum
from sysid.identification.problem import Weights, loop_problem
from sysid.identification.result import Fit, TestError
from sysid.models.base import AbstractValve
from sysid.models.motion import Motion, loop_motion

SAME_CONDITION: Final = 0.05
"""Tests whose amplitude and frequency agree to 5 % are one condition."""


def fit_loops(
    loops: Loops,
    *,
    model: str = "generalized",
    variant: str | None = None,
    weights: Weights = "paper",
    held_out: np.ndarray | None = None,
    left_out: Mapping[str, str] | None = None,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> Fit:
    """Fit a valve model to steady loops; no start value is asked.

    Minimises U = Σ_l w_l² Σ_j (F_lj − F̂_lj)² (W11 Eq. 11).

    Args:
        loops: L tests.
        model: Name in `FAMILIES`.
        variant: One of the model's variants; its first if None.
        weights: "paper" (w = 1), "peak" (1/max|F|) or "noise" (1/noise floor).
        held_out: [L] True for tests that only measure the error.
        left_out: Id → reason, of tests of the campaign that are not in `loops`.
        seed: Of the scatter of starts.
        progress: Called with a line now and then.

    Raises:
        FitError: Fewer points than parameters, an unknown current, an unknown model.
    """
    kind = family(model, variant)
    variant = variant or kind.variants[0]
    held_out = np.zeros(len(loops.ids), dtype=bool) if held_out is None else held_out
    used = loops.select(~held_out)
    if not used.ids:
        raise FitError("no test is left to fit", advice="Hold out or exclude fewer tests")
    problem = loop_problem(used, weights)
    coordinates = kind.coordinates(problem.reference, variant)
    first = kind.start(loop_features(used), coordinates)
    minimum = find_minimum(coordinates, (problem,), first, seed=seed, progress=progress)
    valve = coordinates.valve(jnp.asarray(minimum.u))
    return Fit(
        model=model,
        variant=variant,
        weights=weights,
        valve=valve,
        coordinates=coordinates,
        u=minimum.u,
        problem=problem,
        condition=conditions(used),
        cost=minimum.cost,
        result=minimum.result,
        starts=minimum.starts,
        basins=minimum.basins,
        tests=(
            *loop_errors(valve, loops, held_out),
            *(_absent(name, reason) for name, reason in (left_out or {}).items()),
        ),
    )


def loop_errors(
    valve: AbstractValve, loops: Loops, held_out: np.ndarray | None = None
) -> tuple[TestError, ...]:
    """Free-run error of a model on every loop.

    Args:
        valve: The model.
        loops: L tests.
        held_out: [L] True for tests that were not fitted; none if None.
    """
    held = np.zeros(len(loops.ids), dtype=bool) if held_out is None else held_out
    simulated = np.asarray(_force(valve, loop_motion(loops)))
    rmse = np.sqrt(np.mean((simulated - loops.force) ** 2, axis=1))
    peak, spread = np.abs(loops.force).max(axis=1), loops.force.std(axis=1)
    return tuple(
        TestError(
            id=loops.ids[k],
            rmse=float(rmse[k]),
            nrmse=float(rmse[k] / peak[k]),
            fit_percent=float(100.0 * (1.0 - rmse[k] / spread[k])),
            noise_floor=float(loops.noise_floor[k]),
            held_out=bool(held[k]),
            used=not held[k],
        )
        for k in range(len(loops.ids))
    )


@eqx.filter_jit
def _force(valve: AbstractValve, motion: Motion) -> jnp.ndarray:
    return valve.force(motion)


def conditions(loops: Loops) -> np.ndarray:
    """Number of the (amplitude, frequency) condition of each test, [L], from 0."""
    keys = np.log(np.stack([loops.amplitude, loops.frequency], axis=1))
    number = np.full(len(loops.ids), -1)
    seen: list[np.ndarray] = []
    for k, key in enumerate(keys):
        near = [c for c, other in enumerate(seen) if np.abs(key - other).max() < SAME_CONDITION]
        if not near:
            seen.append(key)
        number[k] = near[0] if near else len(seen) - 1
    return number


def _absent(name: str, reason: str) -> TestError:
    nan = float("nan")
    return TestError(name, nan, nan, nan, nan, held_out=False, used=False, why_not=reason)
