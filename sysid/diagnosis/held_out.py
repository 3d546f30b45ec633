"""Errors on tests that a model has not seen: every condition predicted without it, free run."""

from typing import Final

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

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
DRAWS: Final = 2000
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
    return errors_and_shapes_left_out(evidence, state, tolerance)[0]


def errors_and_shapes_left_out(
    evidence: Evidence, state: State, tolerance: float = TOLERANCE
) -> Float[np.ndarray, "both loop"]:
    """The same both ways: [0] counting what is constant through a test, [1] not."""
    outs = [evidence.condition == number for number in np.unique(evidence.condition)]
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

    Args:
        evidence: The campaign.
        state: The model, fitted to all tests.
        out: [L] those that are left out.
        tolerance: Of the fit.
        here: What `Evidence.look` gives at the fit to all tests, in its shapes, if that is known.
    """
    kept = ~out

    def look(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        if here is not None and np.array_equal(z, state.u):
            residual, jacobian = here
        else:
            residual, jacobian = evidence.look(state.coordinates, z)
        return residual[kept], jacobian[kept]

    covariance = Covariance(evidence.parts.of(kept), state.sizes)
    gls = gauss_newton(look, state.u, covariance, max_steps=STEPS, tolerance=tolerance)
    return evidence.errors_and_shapes(valve_at(state.coordinates, jnp.asarray(gls.u)))


def gain_of(
    evidence: Evidence,
    before: Float[np.ndarray, " loop"],
    after: Float[np.ndarray, " loop"],
    extrapolation: tuple[tuple[str, float, float], ...] = (),
    seed: int = 0,
) -> Gain:
    """What an extension is worth, with a bootstrap over conditions.

    Args:
        evidence: The campaign.
        before: [L] held-out errors of the base model.
        after: [L] of the extended model.
        extrapolation: Further splits.
        seed: Of the bootstrap.
    """
    scatter = evidence.loops.noise_floor / evidence.peak
    floor = scatter / np.sqrt(evidence.loops.cycles)
    floor = np.where(np.isfinite(floor), floor, 0.0)
    rng = np.random.default_rng(seed)
    numbers = np.unique(evidence.condition)
    sums = np.array(
        [[z[evidence.condition == c].sum() for c in numbers] for z in (before, after, floor)]
    )
    drawn = sums[:, rng.integers(numbers.size, size=(DRAWS, numbers.size))].sum(axis=2)
    room = np.maximum(drawn[0] - drawn[2], 1e-12)
    low, high = np.percentile((drawn[0] - drawn[1]) / room, [2.5, 97.5])
    reducible = max(float(before.mean() - floor.mean()), 1e-12)
    known = scatter[np.isfinite(scatter)]
    return Gain(
        before=float(before.mean()),
        after=float(after.mean()),
        floor=float(floor.mean()),
        repeatability=float(known.mean()) if known.size else float("nan"),
        reducible_explained=float(before.mean() - after.mean()) / reducible,
        low=float(low),
        high=float(high),
        per_test_before=before,
        per_test_after=after,
        held_out=evidence.loops.ids,
        extrapolation=extrapolation,
    )


def extrapolate(
    evidence: Evidence, before: State, after: State
) -> tuple[tuple[str, float, float], ...]:
    """Errors on the extreme tests by models that were fitted without them."""
    loops = evidence.loops
    quantities = {
        "the largest amplitudes": loops.amplitude,
        "the highest frequencies": loops.frequency,
        "the largest currents": np.abs(loops.current),
        "the highest temperatures": loops.temperature,
    }
    found = []
    for words, values in quantities.items():
        if not np.isfinite(values).all() or np.ptp(values) < 0.05 * np.abs(values).max():
            continue
        out = values >= values.max() - (1.0 - EXTREME) * np.ptp(values)
        if out.all() or (~out).sum() < 0.3 * out.size:
            continue
        errors = [float(errors_without(evidence, s, out)[0, out].mean()) for s in (before, after)]
        found.append((words, errors[0], errors[1]))
    return tuple(found)
