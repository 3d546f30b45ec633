"""Errors on tests that a model has not seen: every condition predicted without it, free run."""

from typing import Final

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float
from scipy.special import stdtrit

from sysid.diagnosis.acting import acting, not_known, without
from sysid.diagnosis.at_once import at_once
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.result import Gain
from sysid.diagnosis.state import State
from sysid.likelihood.discrepancy import Covariance
from sysid.likelihood.gls import gauss_newton
from sysid.models.coordinates import valve_at

STEPS: Final = 12
"""Gauss–Newton steps from the fit to all tests towards that without some of them."""
TOLERANCE: Final = 1e-3
"""Of these fits, in the sense of `gauss_newton`."""
FEWEST: Final = 3
"""Conditions below which a gain has no interval."""
EXTREME: Final = 0.9
"""Tests from this part of the largest value on are left out for extrapolation."""


def leave_conditions_out(
    evidence: Evidence, state: State, tolerance: float = TOLERANCE
) -> Float[np.ndarray, " loop"]:
    """RMSE/max|F| of each test, predicted by the model fitted without its condition.

    A condition is an amplitude and a frequency, with all its currents.

    Args:
        evidence: The campaign.
        state: The model, fitted to all tests.
        tolerance: Of the fits.
    """
    return errors_in_blocks(evidence, state, None, tolerance)[0]


def errors_in_blocks(
    evidence: Evidence, state: State, blocks: int | None, tolerance: float = TOLERANCE
) -> Float[np.ndarray, "both loop"]:
    """`Evidence.errors_and_shapes` of each test, with conditions left out several at a time.

    Of n blocks each has every n-th condition in order of amplitude, frequency and temperature, so
    that it is predicted from its neighbours, in whatever order tests come.

    Args:
        evidence: The campaign.
        state: The model, fitted to all tests.
        blocks: At most; None for as many as there are conditions.
        tolerance: Of the fits.
    """
    number = evidence.ordered_condition
    if blocks is not None:
        number = number % blocks
    outs = [number == k for k in np.unique(number)]
    if len(outs) < 2:  # nothing to predict from
        return evidence.errors_and_shapes(valve_at(state.coordinates, jnp.asarray(state.u)))
    here = evidence.look(state.coordinates, state.u)  # where all of them start
    found = at_once(lambda out: errors_without(evidence, state, out, tolerance, here)[:, out], outs)
    error = np.empty((2, evidence.tests))
    for out, errors in zip(outs, found, strict=True):
        error[:, out] = errors
    return error


def errors_without(
    evidence: Evidence,
    state: State,
    out: Bool[np.ndarray, " loop"],
    tolerance: float = TOLERANCE,
    here: tuple[np.ndarray, np.ndarray] | None = None,
) -> Float[np.ndarray, "both loop"]:
    """`Evidence.errors_and_shapes` of all tests by a model that was fitted without some of them.

    The fit begins at that to all tests.  An effect that acts in none of those that are kept would
    stay as the others have it: the model is without it.

    Args:
        evidence: The campaign.
        state: The model, fitted to all tests.
        out: [L] those that are left out.
        tolerance: Of the fit.
        here: What `Evidence.look` gives at the fit to all tests, in its shapes, if that is known.
    """
    kept = ~out
    start = evidence.look(state.coordinates, state.u) if here is None else here

    def look(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        if np.array_equal(z, state.u):
            residual, jacobian = start
        else:
            residual, jacobian = evidence.look(state.coordinates, z)
        return residual[kept], jacobian[kept]

    covariance = Covariance(evidence.parts.of(kept), state.sizes)
    gls = gauss_newton(look, state.u, covariance, max_steps=STEPS, tolerance=tolerance)
    damper = valve_at(state.coordinates, jnp.asarray(gls.u))
    unseen = not_known(state.coordinates, start[1], kept)
    return evidence.errors_and_shapes(without(damper, unseen))


def gain_of(
    evidence: Evidence,
    before: Float[np.ndarray, " loop"],
    after: Float[np.ndarray, " loop"],
    extrapolation: tuple[tuple[str, float, float], ...] = (),
) -> Gain:
    """What an extension is worth, with an interval by the jackknife over conditions.

    Resampling a few conditions makes intervals that are too narrow (79 % of those for four
    conditions hold the truth); the jackknife's have Student's t.

    Args:
        evidence: The campaign.
        before: [L] held-out errors of the base model.
        after: [L] of the extended model.
        extrapolation: Further splits.
    """
    scatter = evidence.loops.noise_floor / evidence.peak
    floor = evidence.loops.mean_cycle_noise / evidence.peak
    known = np.isfinite(floor)
    mean_floor = float(floor[known].mean()) if known.any() else float("nan")
    floor = np.where(known, floor, mean_floor if known.any() else 0.0)
    numbers = np.unique(evidence.condition)
    sums = np.array(
        [[z[evidence.condition == c].sum() for c in numbers] for z in (before, after, floor)]
    )
    low, high = _jackknifed(sums)
    return Gain(
        before=float(before.mean()),
        after=float(after.mean()),
        floor=mean_floor,
        repeatability=float(scatter[known].mean()) if known.any() else float("nan"),
        reducible_explained=float(_explained(sums.sum(axis=1))),
        low=low,
        high=high,
        per_test_before=before,
        per_test_after=after,
        held_out=evidence.loops.ids,
        extrapolation=extrapolation,
    )


def _explained(sums: Float[np.ndarray, "three *draw"]) -> Float[np.ndarray, " *draw"]:
    """(before − after)/(before − floor); NaN where nothing could be explained."""
    before, after, floor = sums
    room = before - floor
    return np.where(room > 0.0, (before - after) / np.where(room > 0.0, room, 1.0), np.nan)


def _jackknifed(sums: Float[np.ndarray, "three condition"]) -> tuple[float, float]:
    """Ends of the 95 % interval of what is explained; NaN for few conditions."""
    count = sums.shape[1]
    if count < FEWEST:
        return float("nan"), float("nan")
    value = float(_explained(sums.sum(axis=1)))
    left_out = _explained(sums.sum(axis=1, keepdims=True) - sums)
    error = np.sqrt((count - 1) / count * np.sum((left_out - left_out.mean()) ** 2))
    reach = float(stdtrit(count - 1, 0.975) * error)
    return value - reach, value + reach


def extrapolate(
    before: tuple[Evidence, State], after: tuple[Evidence, State]
) -> tuple[tuple[str, float, float], ...]:
    """Errors on the extreme tests by models that were fitted without them.

    Where a parameter acts in no other test, as what a table has at the largest current, there is
    nothing to predict these from, and no error is told.

    Args:
        before: The tests as they were, and the base model fitted to them.
        after: The same tests, without what was taken out of their cycles, and the extended model.
    """
    loops = after[0].loops
    quantities = {
        "the largest amplitudes": loops.amplitude,
        "the highest frequencies": loops.frequency,
        "the largest currents": np.abs(loops.current),
        "the highest temperatures": loops.temperature,
    }
    both = (before, after)
    here = [evidence.look(s.coordinates, s.u) for evidence, s in both]
    found = []
    for words, values in quantities.items():
        if not np.isfinite(values).all() or np.ptp(values) < 0.05 * np.abs(values).max():
            continue
        out = values >= values.max() - (1.0 - EXTREME) * np.ptp(values)
        if out.all() or (~out).sum() < 0.3 * out.size:
            continue
        if not all(acting(jacobian, ~out).all() for _, jacobian in here):
            continue
        one, other = (
            float(errors_without(evidence, s, out, here=z)[0, out].mean())
            for (evidence, s), z in zip(both, here, strict=True)
        )
        found.append((words, one, other))
    return tuple(found)
