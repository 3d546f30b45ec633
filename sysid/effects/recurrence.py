"""Linear recurrences of third order along a signal, periodic or from rest.

    y_n = b_n + Σ_m g_{m,n} y_{n−m},   m = 1 … 3

A pass through the signal gives the answer from rest; where the signal is periodic, the history
that repeats itself follows from the answers to three unit histories.
"""

from typing import Final

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

ORDER: Final = 3

Signal = Float[Array, "*batch n"]
Memory = Float[Array, "3 *batch n"]
Free = Float[Array, "3 *batch n"]
"""Answers to unit histories y₋₁, y₋₂ and y₋₃ without drive."""


def solve_recurrence(drive: Signal, memory: Memory, *, periodic: bool) -> tuple[Signal, Free]:
    """The answer, and those to unit histories for `solve_again`; zero where there is no cycle.

    Args:
        drive: b, [..., n].
        memory: g, [3, ..., n].
        periodic: y_{−1} is y_{n−1}; otherwise the history is zero.
    """
    if not periodic:
        return solve_again(drive, memory, jnp.zeros_like(memory), periodic=False), 0.0 * memory
    units = jnp.eye(ORDER, ORDER + 1, k=1)
    shape = (ORDER, ORDER + 1, *drive.shape[:-1])
    history = jnp.broadcast_to(units.reshape(*units.shape, *[1] * (drive.ndim - 1)), shape)
    drives = jnp.zeros((ORDER + 1, *drive.shape)).at[0].set(drive)
    answers = _passed(drives, memory, history)
    return _closed(answers[0], answers[1:]), answers[1:]


def solve_again(drive: Signal, memory: Memory, free: Free, *, periodic: bool) -> Signal:
    """The answer for another drive, in which it is linear.

    Args:
        drive: b, [..., n].
        memory: g, [3, ..., n].
        free: From `solve_recurrence` with the same memory.
        periodic: As there.
    """
    history = jnp.zeros((ORDER, 1, *drive.shape[:-1]))
    answer = _passed(drive[None], memory, history)[0]
    return _closed(answer, free) if periodic else answer


def _passed(
    drives: Float[Array, "columns *batch n"],
    memory: Memory,
    history: Float[Array, "3 columns *batch"],
) -> Float[Array, "columns *batch n"]:
    def step(past: jax.Array, now: tuple[jax.Array, jax.Array]) -> tuple[jax.Array, jax.Array]:
        b, g = now
        y = b + g[0] * past[0] + g[1] * past[1] + g[2] * past[2]
        return jnp.stack([y, past[0], past[1]]), y

    inputs = (jnp.moveaxis(drives, -1, 0), jnp.moveaxis(memory, -1, 0))
    return jnp.moveaxis(jax.lax.scan(step, history, inputs)[1], 0, -1)


def _closed(answer: Signal, free: Free) -> Signal:
    """Add the history h that repeats itself: h = e + E h, by Cramer's rule."""
    newest = jnp.stack([answer[..., -1 - k] for k in range(ORDER)], axis=-1)
    columns = [
        jnp.stack([float(j == k) - free[k, ..., -1 - j] for j in range(ORDER)], axis=-1)
        for k in range(ORDER)
    ]
    a, b, c = columns
    normals = (jnp.cross(b, c), jnp.cross(c, a), jnp.cross(a, b))
    whole = jnp.sum(a * normals[0], axis=-1)
    shares = [jnp.sum(newest * normal, axis=-1) / whole for normal in normals]
    return sum((h[..., None] * y for h, y in zip(shares, free, strict=True)), start=answer)
