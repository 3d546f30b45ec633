"""Linear recurrences of third order along a signal, periodic or from rest."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

ORDER = 3


def solve_recurrence(
    drive: Float[Array, "*batch n"], memory: Float[Array, "3 *batch n"], *, periodic: bool
) -> Float[Array, "*batch n"]:
    """Solve y_n = b_n + Σ_m g_{m,n} y_{n−m}, m = 1 … 3.

    One pass carries the answer to b and those to three unit histories; where the signal is
    periodic, the history that repeats itself follows from a 3 × 3 system.

    Args:
        drive: b, [..., n].
        memory: g, [3, ..., n].
        periodic: y_{−1} is y_{n−1}; otherwise the history is zero.
    """
    columns = ORDER + 1 if periodic else 1
    shape = (ORDER, columns, *drive.shape[:-1])
    history = jnp.zeros(shape)
    if periodic:
        for k in range(ORDER):
            history = history.at[k, k + 1].set(1.0)

    def step(past: jax.Array, now: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array]:
        b, g = now
        y = jnp.sum(g[:, None] * past, axis=0).at[0].add(b)
        return jnp.concatenate([y[None], past[:-1]]), y

    inputs = (jnp.moveaxis(drive, -1, 0), jnp.moveaxis(memory, -1, 0))
    end, answers = jax.lax.scan(step, history, inputs)
    answers = jnp.moveaxis(answers, 0, -1)
    if not periodic:
        return answers[0]
    end = jnp.moveaxis(end, (0, 1), (-2, -1))
    closed = jnp.linalg.solve(jnp.eye(ORDER) - end[..., 1:], end[..., :1])[..., 0]
    return answers[0] + jnp.sum(jnp.moveaxis(closed, -1, 0)[..., None] * answers[1:], axis=0)
