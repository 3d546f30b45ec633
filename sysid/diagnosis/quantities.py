"""Parameters of a fitted damper in the papers' symbols, with their covariance."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.prototypes import size_of
from sysid.diagnosis.result import Quantity
from sysid.diagnosis.state import State
from sysid.models.coordinates import valve_at
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.parameters import ParamSpec, specs
from sysid.parameters import values as vector_of
from sysid.uncertainty.directions import SINGULAR, directions_of

LEVEL: Final = 0.95
NORMAL: Final = 1.959964
"""Half an interval of that level, in standard deviations."""
AT_BOUND: Final = 0.02
"""Part of its range within which a parameter counts as having run to the end of it."""
FAR: Final = 10.0
"""Standard deviation, in its magnitude, of a parameter that no data hold and no range."""
KNOWN: Final = 0.5
"""A size is determined if its standard deviation is below this part of it."""


@dataclass(frozen=True)
class Values:
    """Free parameters of a damper.

    Attributes:
        symbols: Of the valve, then "id.symbol" of effects.
        values: [k] SI.
        covariance: [k, k].
    """

    symbols: tuple[str, ...]
    values: Float[np.ndarray, " k"]
    covariance: Float[np.ndarray, "k k"]


def free_values(state: State) -> Values:
    """Values of all free parameters and their covariance, Σ being that of the residual.

    Coordinates of bounded parameters hardly move them near a bound.  Scaled to equal information
    they still tell how far the data hold them there, and what is tied to them is not taken to be
    known as well as if they were.  What the data say nothing of is told as open, not as known.
    """
    return values_of(state, np.concatenate(directions_of(state.gls.information), axis=1))


def values_of(state: State, spread: Float[np.ndarray, "n m"]) -> Values:
    """Values of all free parameters of a fit whose errors are known.

    Args:
        state: The fit.
        spread: [n, m] S with SSᵀ the covariance of its coordinates.
    """
    values, slopes, declared = _free(state)
    spread = within_ranges(slopes @ spread, declared)
    return Values(state.coordinates.free, values, spread @ spread.T)


def sensible_covariance(state: State) -> Float[np.ndarray, "k k"]:
    """Covariance of the free parameters if none of them is expected far from where it is.

    As if each had been measured, with the variance of an even distribution over its range, or with
    `FAR` of its magnitude where that has no end: T (H + TᵀD⁻¹T)⁻¹ Tᵀ, T = dθ/du, D diagonal.
    What the data leave open stays open, but by no more than lets a sum of squares still tell what
    they know beside it.
    """
    values, slopes, declared = _free(state)
    magnitude = np.maximum(np.abs(values), [spec.typical for spec in declared])
    room = np.array([spec.high - spec.low for spec in declared])
    own = slopes / np.where(np.isfinite(room), room / np.sqrt(12.0), FAR * magnitude)[:, None]
    information = state.gls.information + own.T @ own
    scale = np.sqrt(np.maximum(np.diagonal(information), 1e-300))
    value, vector = np.linalg.eigh(information / scale[:, None] / scale[None, :])
    spread = slopes @ (vector / scale[:, None]) / np.sqrt(np.maximum(value, SINGULAR))
    return spread @ spread.T


def _free(state: State) -> tuple[np.ndarray, np.ndarray, tuple[ParamSpec, ...]]:
    """Free parameters [k], their change with the solver coordinates [k, n], and declarations."""
    coordinates, u = state.coordinates, jnp.asarray(state.u)
    slopes = jax.jacfwd(lambda z: free_vector(coordinates, z))(u)
    damper = valve_at(coordinates, u)
    of_valve = {spec.symbol: spec for spec in specs(damper.valve)}
    declared = (
        *(of_valve[s] for s in coordinates.valve_coordinates.free),
        *(spec for effect in damper.effects for spec in specs(effect)),
    )
    return np.asarray(free_vector(coordinates, u)), np.asarray(slopes), declared


def within_ranges(
    spread: Float[np.ndarray, "k m"], declared: Sequence[ParamSpec]
) -> Float[np.ndarray, "k m"]:
    """What is left of errors of parameters, some of which lie between two ends for certain.

    As if each of these had been measured with the variance of an even distribution, range²/12:
    one that the data leave open, since it hardly acts at the end of its range, then leaves no more
    open of what goes with it than it can.

    Args:
        spread: [k, m] S, SSᵀ the covariance.
        declared: [k].

    Returns:
        S' with S'S'ᵀ = (C⁻¹ + D)⁻¹, D diagonal with 12/range².
    """
    room = np.array([spec.high - spec.low for spec in declared])
    closed = np.isfinite(room)
    rows = spread[closed] * (np.sqrt(12.0) / room[closed])[:, None]
    _, size, axes = np.linalg.svd(rows, full_matrices=False)
    return spread + (spread @ axes.T) * (1.0 / np.hypot(1.0, size) - 1.0) @ axes


def free_vector(coordinates: DamperCoordinates, u: Float[Array, " n"]) -> Float[Array, " k"]:
    """Free parameters of a damper, in the order of their symbols.

    Args:
        coordinates: Map from u to the damper.
        u: Solver coordinates.
    """
    damper = coordinates.valve(u)
    symbols = [spec.symbol for spec in specs(damper.valve)]
    free = [symbols.index(s) for s in coordinates.valve_coordinates.free]
    return jnp.concatenate(
        [vector_of(damper.valve)[jnp.array(free)], *map(vector_of, damper.effects)]
    )


def effect_quantities(state: State, values: Values) -> tuple[tuple[Quantity, ...], ...]:
    """Parameters of every effect with their intervals."""
    found = []
    first = len(state.coordinates.valve_coordinates.free)
    sd = np.sqrt(np.maximum(np.diagonal(values.covariance), 0.0))
    for effect in state.coordinates.prototypes:
        own = []
        for spec in specs(effect):
            own.append(quantity_of(spec, float(values.values[first]), float(sd[first])))
            first += 1
        found.append(tuple(own))
    return tuple(found)


def quantity_of(spec: ParamSpec, value: float, sd: float) -> Quantity:
    """A parameter with its interval."""
    return Quantity(
        symbol=spec.symbol,
        name=spec.name,
        value=value,
        unit=spec.unit,
        sd=sd,
        low=max(value - NORMAL * sd, spec.low),
        high=min(value + NORMAL * sd, spec.high),
        level=LEVEL,
        identified=bool(0.0 < sd < KNOWN * abs(value)) and not _at_bound(value, spec),
    )


def _at_bound(value: float, spec: ParamSpec) -> bool:
    """The fit ended at the end of a range: its slope there is none of the data's."""
    room = spec.high - spec.low
    return math.isfinite(room) and min(value - spec.low, spec.high - value) < AT_BOUND * room


def added_force(evidence: Evidence, state: State, index: int) -> float:
    """RMS over the campaign of the force that one effect adds, N."""
    damper = valve_at(state.coordinates, jnp.asarray(state.u))
    effects = [e for k, e in enumerate(damper.effects) if k != index]
    ordered = type(damper)(damper.valve, (*effects, damper.effects[index]))
    per_unit = evidence.signature(ordered)
    effect = damper.effects[index]
    size = size_of(effect)
    return float(np.sqrt(np.mean(np.sum((size * per_unit) ** 2, axis=1))))
