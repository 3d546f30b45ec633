"""Implicit steps of many tests at once: singly diagonally implicit Runge–Kutta, full Newton."""

from collections.abc import Callable
from typing import Final, NamedTuple

import jax
import jax.numpy as jnp
from jax import Array, lax

GAMMA: Final = 1.0 - 0.5**0.5
"""Diagonal of the two-stage method of second order that is L-stable and stiffly accurate.

Source: Alexander, Diagonally implicit Runge-Kutta methods for stiff O.D.E.'s, SIAM J. Numer. Anal.
14 (1977) 1006–1021."""
TOLERANCE: Final = 1e-7
"""Largest last change of an unknown, in its unit, with which Newton's iteration ends; what is then
left is far smaller, since convergence is quadratic."""
MOST: Final = 40
"""Iterations of a stage."""
FARTHEST: Final = 1.0
"""Largest change of an unknown in one iteration, in its unit."""


class Stage(NamedTuple):
    """Ends of a stage's iteration: unknowns [n, test], iterations, largest last change."""

    y: Array
    iterations: Array
    change: Array


Equation = Callable[[Array, Array], tuple[Array, Array]]
"""y [n, test], drive [k, test] → U(y) and its rate, both [n, test]."""


def solve_linear(matrix: Array, right: Array) -> Array:
    """Solve [n, n, test] x = [n, test] by Gauss and Jordan, tests side by side.

    Without exchange of rows: the pivots of U'(y) − g f'(y) are those of a passive system and stay
    positive.
    """
    table = jnp.concatenate([matrix, right[:, None]], axis=1)
    for k in range(matrix.shape[0]):
        pivot = table[k] / table[k, k]
        rest = table[:, k].at[k].set(0.0)
        table = (table - rest[:, None] * pivot[None]).at[k].set(pivot)
    return table[:, -1]


def _stage(equation: Equation, guess: Array, wanted: Array, drive: Array, g: Array) -> Stage:
    """Y with U(y) − g f(y) = wanted."""
    n = guess.shape[0]
    basis = jnp.eye(n, dtype=guess.dtype)

    def residual(y: Array) -> Array:
        held, rate = equation(y, drive)
        return held - g * rate - wanted

    def improve(stage: Stage) -> Stage:
        error, push = jax.linearize(residual, stage.y)
        columns = jax.vmap(lambda e: push(jnp.broadcast_to(e[:, None], stage.y.shape)))(basis)
        change = solve_linear(jnp.swapaxes(columns, 0, 1), -error)
        size = jnp.max(jnp.abs(change), axis=0)
        change = change * jnp.minimum(1.0, FARTHEST / size)
        return Stage(stage.y + change, stage.iterations + 1, jnp.max(size))

    start = Stage(guess, jnp.asarray(0), jnp.asarray(jnp.inf))
    return lax.while_loop(
        lambda stage: (stage.change > TOLERANCE) & (stage.iterations < MOST), improve, start
    )


def integrate(
    equation: Equation, start: Array, drives: tuple[Array, Array], steps: Array
) -> tuple[Array, Array, Array]:
    """Go through all steps.

    Args:
        equation: What is integrated.
        start: y, [n, test].
        drives: At the two stages of each step, each [step, k, test].
        steps: Lengths, s, [step, test].

    Returns:
        y at the ends of the steps [step, n, test], iterations of each step [step], the largest
        last change of any iteration.
    """
    # a stage wants U of the step's start and, if it is the second, a share of what the first gained
    shares = jnp.asarray([0.0, (1.0 - GAMMA) / GAMMA])

    def stage(carry: tuple[Array, ...], given: tuple[Array, Array]):
        y, held, gained, g = carry
        drive, share = given
        end = _stage(equation, y, held + share * gained, drive, g)
        reached = equation(end.y, drive)[0]
        return (end.y, held, reached - held, g), (end.iterations, end.change)

    def step(carry: tuple[Array, Array, Array], given: tuple[Array, Array, Array]):
        y, held, worst = carry
        *drive, h = given
        start = (y, held, jnp.zeros_like(held), GAMMA * h)
        (y, held, gained, _), (counts, changes) = lax.scan(stage, start, (jnp.stack(drive), shares))
        worst = jnp.maximum(worst, jnp.max(changes))
        return (y, held + gained, worst), (y, jnp.sum(counts))

    held = equation(start, drives[0][0])[0]
    (_, _, worst), (ys, counts) = lax.scan(step, (start, held, jnp.asarray(0.0)), (*drives, steps))
    return ys, counts, worst
