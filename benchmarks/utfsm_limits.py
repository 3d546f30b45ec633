"""What limits the model of a measured damper: how far errors fall where more of it is left free.

None of this is a model of the damper.  Each row gives a part of the model more freedom than physics
would, and so bounds from below what any better law for that part could reach.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import jax.numpy as jnp
import numpy as np

from sysid.diagnosis.evidence import Evidence, gather
from sysid.diagnosis.held_out import STEPS
from sysid.diagnosis.plain import NONE, plainly_fitted, unweighted
from sysid.diagnosis.result import Diagnosis
from sysid.diagnosis.state import State
from sysid.likelihood.discrepancy import Covariance
from sysid.likelihood.gls import gauss_newton
from sysid.models.coordinates import place_of, valve_at
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.models.simulate import simulate

TOLERANCE: Final = 1e-3
Row = tuple[str, float, float]
"""What is free; error in sample, and on conditions left out (NaN where that makes no sense)."""


def limits(found: Diagnosis) -> Iterator[Row]:
    """Rows from the extended model to the freest."""
    loops, evidence = found.loops, unweighted(gather(found.loops))
    coordinates = DamperCoordinates(found.fit.coordinates, found.damper.effects)
    state = plainly_fitted(evidence, coordinates, np.asarray(place_of(coordinates, found.damper)))
    everything = np.ones(evidence.tests, dtype=bool)
    whole = _force(evidence, state)
    unseen = np.empty_like(whole)
    by_current, unseen_by_current = whole.copy(), np.empty_like(whole)
    current = np.unique(loops.current.round(3), return_inverse=True)[1]
    for number in np.unique(evidence.condition):
        out = evidence.condition == number
        fitted = _force(evidence, _refitted(evidence, state, ~out))
        unseen[out] = fitted[out]
        unseen_by_current[out] = _adjusted(evidence, fitted, current, ~out, 1)[out]
    yield "the model with its effects", *_errors(evidence, whole, unseen)
    by_current = _adjusted(evidence, whole, current, everything, 1)
    yield (
        "and a gain of its own for each current",
        *_errors(evidence, by_current, unseen_by_current),
    )
    for words, groups in (
        ("all parameters of its own for each current", current),
        ("all parameters of its own for each amplitude and frequency", evidence.condition),
    ):
        apart = np.empty_like(whole)
        for number in np.unique(groups):
            own = groups == number
            apart[own] = _force(evidence, _refitted(evidence, state, own))[own]
        yield words, *_errors(evidence, apart, None)
    test = np.arange(evidence.tests)
    for words, terms in (
        ("a gain of its own for each test", 1),
        ("gain and offset for each test", 2),
        ("gain, offset and delay for each test", 3),
    ):
        yield words, *_errors(evidence, _adjusted(evidence, whole, test, everything, terms), None)
    apart = np.stack([
        _force(evidence, _refitted(evidence, state, test == k))[k] for k in test
    ])  # fmt: skip
    yield "all parameters of its own for each test", *_errors(evidence, apart, None)


def _force(evidence: Evidence, state: State) -> np.ndarray:
    damper = valve_at(state.coordinates, jnp.asarray(state.u))
    return np.asarray(simulate(damper, evidence.motion))[: evidence.tests]


def _refitted(evidence: Evidence, state: State, kept: np.ndarray) -> State:
    """Fitted to some of the tests."""

    def look(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        residual, jacobian = evidence.look(state.coordinates, z)
        return residual[kept], jacobian[kept]

    covariance = Covariance(evidence.parts.of(kept), NONE)
    gls = gauss_newton(look, state.u, covariance, max_steps=STEPS, tolerance=TOLERANCE)
    return replace(state, gls=gls)


def _adjusted(
    evidence: Evidence, force: np.ndarray, groups: np.ndarray, seen: np.ndarray, terms: int
) -> np.ndarray:
    """The force with gain, offset and delay (the first `terms` of them) fitted to each group."""
    slope = np.gradient(np.pad(force, ((0, 0), (1, 1)), mode="wrap"), axis=1)[:, 1:-1]
    free = np.stack([force, np.ones_like(force), slope], axis=2)[:, :, :terms]
    adjusted = force.copy()
    for number in np.unique(groups):
        own = groups == number
        used = own & seen
        scale = 1.0 / evidence.peak[used, None]
        design = (free[used] * scale[:, :, None]).reshape(-1, terms)
        missing = ((evidence.force - force)[used] * scale).ravel()
        adjusted[own] += free[own] @ np.linalg.lstsq(design, missing, rcond=None)[0]
    return adjusted


def _errors(
    evidence: Evidence, force: np.ndarray, unseen: np.ndarray | None
) -> tuple[float, float]:
    """Mean over tests of RMSE/max|F|, in sample and unseen."""

    def mean(simulated: np.ndarray) -> float:
        rms = np.sqrt(np.mean((simulated - evidence.force) ** 2, axis=1))
        return float((rms / evidence.peak).mean())

    return mean(force), np.nan if unseen is None else mean(unseen)
