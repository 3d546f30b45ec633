"""Entry point: from loops to a fitted model."""

from collections.abc import Callable, Mapping, Sequence

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops
from sysid.data.record import Record
from sysid.errors import FitError
from sysid.identification.conditions import conditions
from sysid.identification.families import family
from sysid.identification.features import loop_features
from sysid.identification.multistart import MAX_WAVES, find_minimum
from sysid.identification.problem import (
    Problem,
    Weights,
    loop_problem,
    record_motion,
    record_problem,
)
from sysid.identification.result import Fit, TestError
from sysid.models.base import AbstractModel
from sysid.models.coordinates import valve_at
from sysid.models.simulate import simulate
from sysid.motion.history import RunHistory, with_history
from sysid.motion.motion import loop_motion


def fit_loops(
    loops: Loops,
    *,
    model: str = "generalized",
    variant: str | None = None,
    weights: Weights = "paper",
    others: Sequence[Record] = (),
    held_out: np.ndarray | None = None,
    left_out: Mapping[str, str] | None = None,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
    max_waves: int = MAX_WAVES,
) -> Fit:
    """Fit a valve model to steady loops; no start value is asked.

    Minimises U = Σ_l w_l² Σ_j (F_lj − F̂_lj)² (W11 Eq. 11).

    Args:
        loops: L tests.
        model: Name in `FAMILIES`.
        variant: One of the model's variants; its first if None.
        weights: "paper" (w = 1), "peak" (1/max|F|) or "noise" (1/noise floor).
        others: R tests that are not sinusoidal; fitted on their own time grids.
        held_out: [L + R] True for tests that only measure the error, loops first.
        left_out: Id → reason, of tests of the campaign that are in neither.
        seed: Of the scatter of starts.
        progress: Called with a line now and then.
        max_waves: Waves of starts at most.

    Raises:
        FitError: Fewer points than parameters, an unknown current, an unknown model.
    """
    kind = family(model, variant)
    variant = variant or kind.variants[0]
    count = len(loops.ids)
    held = np.zeros(count + len(others), dtype=bool) if held_out is None else held_out
    used = loops.select(~held[:count])
    used_others = [r for r, out in zip(others, held[count:], strict=True) if not out]
    problems = _problems(used, used_others, weights)
    coordinates = kind.coordinates_for(problems, variant)
    first = kind.start(loop_features(used) if used.ids else None, coordinates)
    minimum = find_minimum(
        coordinates, problems, first, seed=seed, progress=progress, max_waves=max_waves
    )
    valve = valve_at(coordinates, jnp.asarray(minimum.u))
    return Fit(
        model=model,
        variant=variant,
        weights=weights,
        valve=valve,
        coordinates=coordinates,
        u=minimum.u,
        problems=problems,
        condition=conditions(used),
        cost=minimum.cost,
        result=minimum.result,
        starts=minimum.starts,
        basins=minimum.basins,
        tests=(
            *loop_errors(valve, loops, held[:count]),
            *record_errors(valve, others, held[count:]),
            *(_absent(name, reason) for name, reason in (left_out or {}).items()),
        ),
        notes=coordinates.remarks,
    )


def _problems(loops: Loops, others: Sequence[Record], weights: Weights) -> tuple[Problem, ...]:
    """One problem for the loops and one for the other records, with the same reference."""
    if not loops.ids and not others:
        raise FitError("no test is left to fit", advice="Hold out or exclude fewer tests")
    if not loops.ids:
        return (record_problem(others, weights),)
    problem = loop_problem(loops, weights)
    if not others:
        return (problem,)
    return (problem, record_problem(others, weights, reference=problem.reference))


def loop_errors(
    model: AbstractModel,
    loops: Loops,
    held_out: np.ndarray | None = None,
    history: RunHistory | None = None,
) -> tuple[TestError, ...]:
    """Free-run error of a model on every loop.

    Args:
        model: The model, with or without effects.
        loops: L tests.
        held_out: [L] True for tests that were not fitted; none if None.
        history: Of the L tests, if their order is known.
    """
    if not loops.ids:
        return ()
    motion = with_history(loop_motion(loops), history)
    return errors_of(loops, np.asarray(simulate(model, motion)), held_out)


def errors_of(
    loops: Loops, simulated: Float[np.ndarray, "loop phase"], held_out: np.ndarray | None = None
) -> tuple[TestError, ...]:
    """Errors of simulated loops.

    Args:
        loops: L tests.
        simulated: [L, J] N.
        held_out: [L] True for tests that were not fitted; none if None.
    """
    held = np.zeros(len(loops.ids), dtype=bool) if held_out is None else held_out
    return tuple(
        _error(name, loops.force[k], simulated[k], float(loops.noise_floor[k]), bool(held[k]))
        for k, name in enumerate(loops.ids)
    )


def record_errors(
    model: AbstractModel, records: Sequence[Record], held_out: np.ndarray | None = None
) -> tuple[TestError, ...]:
    """Free-run error of a model on whole records that are not sinusoidal.

    Args:
        model: The model, with or without effects.
        records: R tests.
        held_out: [R] True for tests that were not fitted; none if None.
    """
    held = np.zeros(len(records), dtype=bool) if held_out is None else held_out
    return tuple(
        _error(
            record.id,
            record.force,
            np.asarray(simulate(model, record_motion(record))),
            float("nan"),
            bool(out),
        )
        for record, out in zip(records, held, strict=True)
    )


def _error(
    name: str, measured: np.ndarray, simulated: np.ndarray, noise_floor: float, held_out: bool
) -> TestError:
    rmse = float(np.sqrt(np.mean((simulated - measured) ** 2)))
    return TestError(
        id=name,
        rmse=rmse,
        nrmse=rmse / float(np.abs(measured).max()),
        fit_percent=100.0 * (1.0 - rmse / float(measured.std())),
        noise_floor=noise_floor,
        held_out=held_out,
        used=not held_out,
    )


def _absent(name: str, reason: str) -> TestError:
    nan = float("nan")
    return TestError(name, nan, nan, nan, nan, held_out=False, used=False, why_not=reason)
