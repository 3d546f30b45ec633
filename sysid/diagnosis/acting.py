"""In which tests parameters act, and what tests that are kept cannot tell of."""

from typing import Any, Final

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from sysid.models.coordinates import AbstractCoordinates
from sysid.models.damper import Damper
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.parameters import specs

NOTHING: Final = 1e-4
"""Part of what a parameter does, squared, that is none: one that acts by less than a hundredth in
the tests that are kept is known from those that are left out."""


def acting(
    jacobian: Float[np.ndarray, "loop m n"], kept: Bool[np.ndarray, " loop"]
) -> Bool[np.ndarray, " n"]:
    """Parameters that act in some test that is kept, or in none at all.

    Args:
        jacobian: Of all L tests.
        kept: [L] those that are not left out.
    """
    acts = np.sum(jacobian**2, axis=1)
    whole = acts.sum(axis=0)
    return (acts[kept].sum(axis=0) > NOTHING * whole) | (whole == 0.0)


def not_known(
    coordinates: AbstractCoordinates[Any],
    jacobian: Float[np.ndarray, "loop m n"],
    kept: Bool[np.ndarray, " loop"],
) -> tuple[int, ...]:
    """Places of the effects whose size acts in none of the tests that are kept.

    Args:
        coordinates: Of the model.
        jacobian: Of all L tests in these.
        kept: [L] those that are not left out.
    """
    if not isinstance(coordinates, DamperCoordinates) or not coordinates.prototypes:
        return ()
    known = acting(jacobian, kept)
    first, found = coordinates.valve_coordinates.size, []
    for k, effect in enumerate(coordinates.prototypes):
        symbols = [spec.symbol for spec in specs(effect)]
        if not known[first + symbols.index(effect.facts.size)]:
            found.append(k)
        first += len(symbols)
    return tuple(found)


def without(damper: Damper, places: tuple[int, ...]) -> Damper:
    """The damper with no size of some of its effects.

    Args:
        damper: With effects.
        places: Of those that are to do nothing.
    """
    for k in places:
        symbol = damper.effects[k].facts.size
        damper = eqx.tree_at(
            lambda d, k=k, symbol=symbol: getattr(d.effects[k], symbol),
            damper,
            replace_fn=jnp.zeros_like,
        )
    return damper
