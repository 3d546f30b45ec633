"""Paths along one parameter whose cost is known in closed form."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.parameters import ParamSpec
from sysid.uncertainty.profile_paths import DAMPING, Ground, Path, Point, Way, follow

DECLARED = ParamSpec(
    symbol="x", name="made up", unit="-", low=-np.inf, high=np.inf, typical=1.0, scale="linear"
)


def path_of(residual: Callable[[jax.Array], jax.Array], begin: float = 0.0) -> Path:
    """Outwards from an optimum, θ = u, cost ‖residual(u)‖²."""
    slopes = jax.jit(jax.jacfwd(residual))

    def look(u: np.ndarray) -> Point:
        r, J = np.asarray(residual(jnp.asarray(u[0]))), np.asarray(slopes(jnp.asarray(u[0])))
        curvature = float(J @ J)
        return Point(
            u=u,
            cost=float(r @ r),
            pull=np.array([-float(J @ r)]),
            sensitivity=np.array([np.sqrt(curvature)]),
            inverse=np.array([[1.0 / (curvature + DAMPING)]]),
            theta=u,
            slopes=np.ones((1, 1)),
        )

    ground = Ground(look, look(np.array([begin])))
    return follow(Way(ground, 0, DECLARED, 1, 1.0, 0.8))


def plateau(u: jax.Array, height: float) -> jax.Array:
    """√rise that levels off at a height, below which an interval ends or not."""
    return height * jnp.tanh(u / height)


@pytest.mark.parametrize("wall", [2.5, 3.0, 7.3])
def test_a_wall_behind_a_plateau_closes_nothing(wall: float):
    """The rise stays at 1.5² = 2.25, below 3.84, until the coordinates end."""
    path = path_of(lambda u: jnp.stack([plateau(u, 1.5), 1e3 * jnp.maximum(u - wall, 0.0) / wall]))
    assert not path.closed
    assert float(path.points[-1].theta[0]) < 1.01 * wall
    assert path.points[-1].cost < 2.6


@pytest.mark.parametrize(
    "residual",
    [
        lambda u: jnp.stack([u, 0.0 * u]),
        lambda u: jnp.stack([u**2, 0.0 * u]),
        lambda u: jnp.stack([0.3 * u + 0.1 * u**3, 0.0 * u]),
        lambda u: jnp.stack([plateau(u, 2.1), 0.0 * u]),
        lambda u: jnp.stack([plateau(u, 1.5), jnp.maximum(u - 4.0, 0.0)]),
    ],
    ids=["straight", "quartic", "steeper", "plateau above the end", "a slope behind a plateau"],
)
def test_what_rises_in_steps_that_can_be_followed_closes(residual):
    path = path_of(residual)
    assert path.closed
    costs = [p.cost for p in path.points]
    assert costs == sorted(costs)
