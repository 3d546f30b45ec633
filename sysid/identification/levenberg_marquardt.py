"""Levenberg–Marquardt for very many residuals and few unknowns.

The residual vector of a large campaign has millions of entries, but a step needs only the Gram
matrix of [J r].  Here it is summed over blocks of tests, and its square root, n + 1 numbers with
an n-column Jacobian, is handed to optimistix' Levenberg–Marquardt as if it were the residual:
same cost, same Gauss–Newton model, memory of one block.
"""

from collections.abc import Callable
from typing import Final

import equinox as eqx
import jax
import jax.numpy as jnp
import lineax as lx
import optimistix as optx
from jaxtyping import Array, Bool, Float, Int, PyTree

from sysid.identification.problem import Problem, weighted
from sysid.models.coordinates import AbstractCoordinates

ROUNDING: Final = 1e-18
"""Cost, relative to that of no model at all, at which only rounding is left."""


class Descent(eqx.Module):
    """Where one run of Levenberg–Marquardt ended.

    Attributes:
        u: [n] solver coordinates.
        cost: Σ w² (F − F̂)² / Σ w² F² there.
        steps: Steps taken.
        converged: The last accepted step lowered the cost by less than the tolerance.
    """

    u: Float[Array, " n"]
    cost: Float[Array, ""]
    steps: Int[Array, ""]
    converged: Bool[Array, ""]


class LevenbergMarquardt(optx.AbstractGaussNewton):
    """optimistix' Levenberg–Marquardt with a trust region that grows on merely good steps.

    optimistix enlarges the region only when a step did 99 % of what was predicted; along curved
    valleys, which Eq. 11 is full of, that keeps the damping high and the run crawling.  The
    classical 3/4 and 1/4 are used instead.
    """

    rtol: float
    atol: float
    norm: Callable[[PyTree], Array]
    descent: optx.AbstractDescent
    search: optx.AbstractSearch
    verbose: Callable[..., None]

    def __init__(self) -> None:
        self.rtol = self.atol = 1e-12
        self.norm = optx.max_norm
        self.descent = optx.DampedNewtonDescent(linear_solver=lx.QR())
        self.search = optx.ClassicalTrustRegion(
            high_cutoff=0.75, low_cutoff=0.25, high_constant=4.0, low_constant=0.25
        )
        self.verbose = _silent


def _silent(**_: tuple[str, Array]) -> None:
    """Progress goes through the callback of the caller, never through the solver."""


def residuals(
    coordinates: AbstractCoordinates, problem: Problem, u: Float[Array, " n"]
) -> Float[Array, "*loop point"]:
    """Weighted residuals w (F̂ − F), [..., n], where statics are free at the best ones."""
    excess = coordinates.valve(u).force(problem.motion) - problem.force
    return weighted(excess, problem.weight, statics_free=coordinates.statics_free)


@eqx.filter_jit
def gram(
    coordinates: AbstractCoordinates, parts: tuple[Problem, ...], u: Float[Array, " n"]
) -> Float[Array, "n+1 n+1"]:
    """[J r]ᵀ[J r] summed over blocks of tests, r relative to the RMS of the measured force.

    The scale matters: damping starts at 1, which must be of the order of the diagonal.

    Args:
        coordinates: Map from u to the model.
        parts: Problems with arrays [B, L, n]: B blocks of L tests on one kind of grid.
        u: [n].
    """
    scale = jnp.sqrt(sum(jnp.sum((p.weight * p.force) ** 2) for p in parts))

    def add(total: Array, block: Problem) -> tuple[Array, None]:
        return total + _gram_of(coordinates, block, u, scale), None

    total = jnp.zeros((u.shape[0] + 1, u.shape[0] + 1))
    for part in parts:
        total = jax.lax.scan(add, total, part)[0]
    return total


@eqx.filter_jit
def gram_of_each(
    coordinates: AbstractCoordinates, blocks: Problem, u: Float[Array, " n"]
) -> Float[Array, "block n+1 n+1"]:
    """[J r]ᵀ[J r] of each block of tests, r as it is.

    Args:
        coordinates: Map from u to the model.
        blocks: Arrays [B, L, n]: B blocks of L tests.
        u: [n].
    """
    return jax.lax.map(lambda block: _gram_of(coordinates, block, u, 1.0), blocks)


def _gram_of(
    coordinates: AbstractCoordinates, block: Problem, u: Float[Array, " n"], scale: Array | float
) -> Float[Array, "n+1 n+1"]:
    r, push = jax.linearize(lambda z: residuals(coordinates, block, z) / scale, u)
    jacobian = jax.vmap(push)(jnp.eye(u.shape[0]))
    full = jnp.concatenate([jacobian, r[None]]).reshape(u.shape[0] + 1, -1)
    return full @ full.T


def square_root(
    coordinates: AbstractCoordinates, parts: tuple[Problem, ...]
) -> Callable[[Array, None], tuple[Array, None]]:
    """The residual function of optimistix: n + 1 numbers whose squares sum to the cost."""

    @jax.custom_jvp
    def reduced(u: Array) -> Array:
        return _factor(gram(coordinates, parts, u))[:, -1]

    @reduced.defjvp
    def _(primals: tuple[Array], tangents: tuple[Array]) -> tuple[Array, Array]:
        factor = _factor(gram(coordinates, parts, primals[0]))
        return factor[:, -1], factor[:, :-1] @ tangents[0]

    return lambda u, _: (reduced(u), None)


def _factor(matrix: Float[Array, "m m"]) -> Float[Array, "m m"]:
    """Upper triangular R with RᵀR = matrix; a ridge of 1e-14 of the diagonal keeps it real."""
    scale = jnp.sqrt(jnp.diagonal(matrix))
    scale = jnp.where(scale > 0.0, scale, 1.0)
    m = matrix.shape[0]
    correlation = matrix / scale[:, None] / scale[None, :] + 1e-14 * jnp.eye(m)
    return jnp.linalg.cholesky(correlation, upper=True) * scale[None, :]


def descend(
    coordinates: AbstractCoordinates,
    parts: tuple[Problem, ...],
    start: Float[Array, " n"],
    *,
    tolerance: float,
    max_steps: int,
    trust: float = 1.0,
) -> Descent:
    """One run from one start.

    Stops when an accepted step lowers the cost by less than `tolerance` of it, twice in a row, or
    after `max_steps`.  Coordinates that run off along a flat valley therefore stop the run as soon
    as they no longer pay.

    Args:
        coordinates: Map from u to the model.
        parts: Problems with arrays [B, L, n].
        start: [n].
        tolerance: Relative decrease of the cost.
        max_steps: Largest number of evaluations of the Jacobian.
        trust: 1/λ of the first step, in units in which the diagonal of JᵀJ is of order one: small
            far from a minimum, large beside one.
    """
    solver = LevenbergMarquardt()
    fn = square_root(coordinates, parts)
    f_struct = jax.ShapeDtypeStruct((start.shape[0] + 1,), start.dtype)
    tags: frozenset[object] = frozenset()
    state = solver.init(fn, start, None, {}, f_struct, None, tags)
    state = eqx.tree_at(lambda s: s.search_state.step_size, state, jnp.asarray(trust))
    dynamic, static = eqx.partition(state, eqx.is_array)

    def cond(carry: tuple) -> Array:
        _, _, _, small, steps = carry
        return (small < 2) & (steps < max_steps)

    def body(carry: tuple) -> tuple:
        u, dynamic, cost, small, steps = carry
        state = eqx.combine(dynamic, static)
        u, state, _ = solver.step(fn, u, None, {}, state, tags)
        new = jnp.sum(state.f_info.residual**2)
        accepted = state.num_steps_since_acceptance == 0
        tiny = accepted & ((new > cost * (1.0 - tolerance)) | (new < ROUNDING))
        small = jnp.where(accepted, jnp.where(tiny, small + 1, 0), small)
        stuck = state.num_steps_since_acceptance > 20
        small = jnp.where(stuck | state.terminate, 2, small)
        dynamic, _ = eqx.partition(state, eqx.is_array)
        return u, dynamic, jnp.where(accepted, new, cost), small, steps + 1

    init = (start, dynamic, jnp.asarray(jnp.inf), jnp.asarray(0), jnp.asarray(0))
    u, dynamic, cost, small, steps = jax.lax.while_loop(cond, body, init)
    return Descent(u, cost, steps, small >= 2)
