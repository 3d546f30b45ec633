"""Levenberg–Marquardt of many starts in lockstep: every start has its own damping."""

from typing import Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from sysid.fleet.normal_equations import Normal, normal_equations
from sysid.fleet.stack import Stack
from sysid.models.generalized_coordinates import Variant

GOOD, BAD = 0.75, 0.25
"""Share of the predicted decrease above which damping falls, and below which it grows."""
FACTOR: Final = 4.0
STUCK: Final = 20
"""Refused steps in a row after which nothing more is to be had."""
ROUNDING: Final = 1e-18
"""Cost, relative to that of no model at all, at which only rounding is left."""


class Walk(eqx.Module):
    """Where each of S starts has got to.

    Attributes:
        u: [S, n] solver coordinates.
        normal: Normal equations there; of infinite cost where not known yet.
        damping: [S] λ, added to the diagonal of JᵀJ, dimensionless.
        small: [S] accepted steps in a row that lowered the cost by less than the tolerance.
        refused: [S] steps in a row that were not accepted.
        steps: [S] steps taken.
    """

    u: Float[Array | np.ndarray, "start n"]
    normal: Normal
    damping: Float[Array | np.ndarray, " start"]
    small: Int[Array | np.ndarray, " start"]
    refused: Int[Array | np.ndarray, " start"]
    steps: Int[Array | np.ndarray, " start"]

    @property
    def converged(self) -> Bool[Array | np.ndarray, " start"]:
        """Two accepted steps in a row hardly lowered the cost, or none lowers it any more."""
        return (self.small >= 2) | (self.refused > STUCK)


def begin(u: Float[np.ndarray, "start n"], damping: float) -> Walk:
    """Walks that stand at their starts, whose costs are not known yet.

    Args:
        u: [S, n].
        damping: λ of the first step, dimensionless: JᵀJ is relative to the squares of the force.
    """
    count, n = u.shape
    none = np.zeros(count, dtype=np.int32)
    # no gradient: the first step goes nowhere and finds out
    normal = Normal(np.zeros((count, n, n)), np.zeros((count, n)), np.full(count, np.inf))
    return Walk(u, normal, np.full(count, damping), none, none, none)


@eqx.filter_jit
def advance(
    variant: Variant, stack: Stack, walk: Walk, tolerance: Float[Array | np.ndarray, ""], steps: int
) -> Walk:
    """Some steps of every walk; those that have converged stand still.

    Args:
        variant: Of the model.
        stack: The damper of each walk, S rows.
        walk: S walks.
        tolerance: Relative decrease of the cost that counts as none.
        steps: How many.
    """
    return jax.lax.fori_loop(0, steps, lambda _, z: _step(variant, stack, z, tolerance), walk)


def _step(variant: Variant, stack: Stack, walk: Walk, tolerance: Array | np.ndarray) -> Walk:
    now, n = walk.normal, walk.u.shape[-1]
    damped = now.matrix + walk.damping[:, None, None] * jnp.eye(n)
    factor = jnp.linalg.cholesky(damped)
    step = -jax.vmap(lambda c, g: jax.scipy.linalg.cho_solve((c, True), g))(factor, now.gradient)
    new = normal_equations(variant, stack, walk.u + step)
    # with (M + λ)δ = −g, the model falls by −gᵀδ + λ|δ|²
    promised = walk.damping * jnp.sum(step**2, axis=-1) - jnp.sum(now.gradient * step, axis=-1)
    ratio = jnp.where(jnp.isfinite(now.cost), (now.cost - new.cost) / promised, 0.5)
    lower = jnp.isfinite(new.cost + jnp.sum(new.gradient, axis=-1)) & (ratio > 0.0)
    accepted, refused = lower & ~walk.converged, ~lower
    damping = jnp.where(
        refused | (ratio < BAD),
        walk.damping * FACTOR,
        jnp.where(ratio > GOOD, walk.damping / FACTOR, walk.damping),
    )
    tiny = (new.cost > now.cost * (1.0 - tolerance)) | (new.cost < ROUNDING)

    def chosen(a: Array | np.ndarray, b: Array | np.ndarray) -> Array:
        return jnp.where(accepted.reshape(-1, *(1,) * (a.ndim - 1)), a, b)

    return Walk(
        u=chosen(walk.u + step, walk.u),
        normal=jax.tree.map(chosen, new, now),
        damping=jnp.maximum(damping, 1e-12),
        small=jnp.where(accepted, jnp.where(tiny, walk.small + 1, 0), walk.small),
        refused=jnp.where(refused, walk.refused + 1, 0),
        steps=walk.steps + ~walk.converged,
    )
