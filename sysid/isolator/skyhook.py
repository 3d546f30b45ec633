"""The skyhook principle: which force is wanted, and when a damper can give it."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Bool

from sysid.isolator.plant import Number


class Sensed(NamedTuple):
    """What a controller knows at a sample.

    Attributes:
        body_velocity: ẋ_m, m/s.
        relative_velocity: ẋ_b − ẋ_m, compression of the damper, m/s.
        force: Of the damper as measured, N.
    """

    body_velocity: Number
    relative_velocity: Number
    force: Number


def dissipative(sensed: Sensed) -> Bool[Array, "..."]:
    """ẋ_m (ẋ_m − ẋ_b) ≥ 0: the skyhook's force takes energy out (BS09 Eq. 2)."""
    return -sensed.body_velocity * sensed.relative_velocity >= 0.0


def demand(damping: Number, sensed: Sensed) -> Number:
    """F_sky = D ẋ_m as a force of the damper, which pushes the mass up: −D ẋ_m (BS09 Eq. 1), N."""
    return -damping * sensed.body_velocity


def along(force: Number, sensed: Sensed) -> Number:
    """A force in the direction of the relative velocity, N.

    A current acts through the magnitude of the force, so errors are taken in this direction.
    """
    return force * jnp.sign(sensed.relative_velocity)
