"""The lumped model's equation as diffrax solves it: all loops at once, compiled."""

from collections.abc import Callable
from functools import partial
from typing import Any

import diffrax  # pyright: ignore[reportMissingImports] of the extra `bench`
import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float
from lumped_reference import C_PRE, MASS, numbers

SOLVERS: dict[str, type[diffrax.AbstractAdaptiveSolver]] = {
    "Tsit5": diffrax.Tsit5,
    "Kvaerno3": diffrax.Kvaerno3,
    "Kvaerno5": diffrax.Kvaerno5,
}
"""An explicit one, which stability keeps to short steps, and two L-stable ones."""
MOST_STEPS = 200_000

Loop = tuple[Array, Array, Array, Array, Array]
"""Amplitude, frequency, C_post, F_y and k."""


def solver_of(
    loops: tuple[np.ndarray, ...], points: int, name: str, tolerance: float, cycles: int
) -> Callable[[], Float[Array, "loop point"]]:
    """A compiled program for the last of some cycles of every loop, phase 2πj/points.

    Args:
        loops: Amplitude m, frequency Hz, current A and temperature °C, [L] each.
        points: Of a cycle.
        name: Of `SOLVERS`.
        tolerance: Relative; the absolute one is 10⁻⁴ of it, in m and m/s.
        cycles: How many are run.
    """
    amplitude, frequency, current, temperature = loops
    element = np.array([numbers(i, t) for i, t in zip(current, temperature, strict=True)])
    rows = tuple(jnp.asarray(z) for z in (amplitude, frequency, *element.T))
    run = eqx.filter_jit(jax.vmap(partial(_force, points, SOLVERS[name](), tolerance, cycles)))
    return lambda: run(*rows)


def _force(
    points: int, solver: diffrax.AbstractAdaptiveSolver, tolerance: float, cycles: int,
    amplitude: Array, frequency: Array, post: Array, yielding: Array, k: Array,
) -> Array:  # fmt: skip
    omega = 2.0 * jnp.pi * frequency

    def rates(t: Any, z: Array, _: None) -> Array:
        u, w = z
        clipped = jnp.clip((C_PRE - post) * w, -yielding, yielding)
        speed = amplitude * omega * jnp.cos(omega * t)
        return jnp.stack([speed - w, (k * u - post * w - clipped) / MASS])

    last = (cycles - 1 + jnp.arange(points) / points) / frequency
    start = jnp.stack([(post * amplitude * omega + yielding) / k, amplitude * omega])
    ran = diffrax.diffeqsolve(
        diffrax.ODETerm(rates), solver, 0.0, cycles / frequency, None, start,
        saveat=diffrax.SaveAt(ts=last), max_steps=MOST_STEPS, throw=False,
        stepsize_controller=diffrax.PIDController(rtol=tolerance, atol=1e-4 * tolerance),
    )  # fmt: skip
    assert ran.ys is not None
    return k * ran.ys[:, 0]
