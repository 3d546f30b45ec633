"""The density that walkers jump to: its own height, what it fits, and what it is good for."""

import numpy as np
import pytest
from emcee.autocorr import integrated_time

from sysid.uncertainty.ensemble import Walkers, random_state, walk
from sysid.uncertainty.jump import Jump, jump_fitted, jump_of, mixture_fitted

N, WALKERS = 4, 48
BEND, THIN = 0.6, 0.25


def bent(u: np.ndarray) -> np.ndarray:
    """Two bent ridges side by side: u_1 about u_0², u_3 about u_2²."""
    along, away = u[:, ::2], u[:, 1::2] - BEND * u[:, ::2] ** 2
    return -0.5 * np.sum(along**2 + (away / THIN) ** 2, axis=1)


def exact(steps: int, seed: int = 0) -> np.ndarray:
    """Draws of `bent`, [step, walker, n]."""
    rng = np.random.default_rng(seed)
    z = rng.standard_normal((steps, WALKERS, N))
    z[..., 1::2] = BEND * z[..., ::2] ** 2 + THIN * z[..., 1::2]
    return z


def fitted(draws: np.ndarray) -> Jump:
    return mixture_fitted(draws, np.random.default_rng(1))


def walked(jump: Jump | None, steps: int = 1500) -> np.ndarray:
    start = exact(1, seed=4)[0]
    return walk(bent, Walkers(start, bent(start), random_state(3, 0)), steps, jump).u


@pytest.mark.parametrize(
    "jump",
    [
        jump_of(np.array([1.0, -2.0]), np.array([[2.0, 0.5], [0.5, 1.0]])),
        Jump(
            np.array([0.3, 0.7]),
            np.array([[1.0, -2.0], [0.0, -1.0]]),
            np.array([[[1.2, 0.0], [0.2, 1.0]], [[1.5, 0.0], [-0.4, 0.9]]]),
        ),
    ],
    ids=["one component", "two"],
)
def test_jumps_know_their_own_density(jump):
    u = jump.draw(200_000, np.random.default_rng(0))
    # importance weights of a normal density must have its normalisation and moments
    centre = np.array([1.0, -2.0])
    weight = np.exp(-0.5 * np.sum((u - centre) ** 2, axis=1) - jump.log_density(u))
    weight /= weight.sum()
    assert weight @ u == pytest.approx(centre, abs=0.03)
    assert weight @ (u[:, 0] - 1.0) ** 2 == pytest.approx(1.0, abs=0.04)


def test_a_normal_density_takes_one_component_and_a_bent_one_several():
    normal = np.random.default_rng(2).standard_normal((100, WALKERS, N))
    assert fitted(normal).weight.size == 1
    assert fitted(exact(100)).weight.size > 2


def test_one_component_is_the_normal_density_of_the_draws():
    root = np.array([[2.0, 0.0, 0.0], [1.0, 0.5, 0.0], [0.0, 0.3, 1e-3]])
    draws = np.random.default_rng(2).standard_normal((200, WALKERS, 3)) @ root.T + 5.0
    jump, plain = fitted(draws), jump_fitted(draws.reshape(-1, 3))
    assert jump.mean[0] == pytest.approx(plain.mean[0], abs=1e-6)
    assert jump.root[0] == pytest.approx(plain.root[0], rel=1e-3, abs=1e-6)
    assert jump.root[0] @ jump.root[0].T == pytest.approx(root @ root.T, rel=0.1, abs=0.02)


def test_a_mixture_of_few_draws_knows_others_better_than_one_density_does():
    few = np.concatenate([exact(4, seed=k) for k in range(4)], axis=2)
    others = np.concatenate([exact(50, seed=9 + k) for k in range(4)], axis=2).reshape(-1, 4 * N)
    several, one = fitted(few), jump_fitted(few.reshape(-1, 4 * N))
    gained = several.log_density(others) - one.log_density(others)
    assert several.weight.size > 1
    assert gained.mean() > 0.5
    assert gained.min() > -10.0


def test_a_bent_ridge_is_walked_faster_with_a_mixture_and_its_draws_are_right():
    one, several = walked(jump_fitted(exact(100).reshape(-1, N))), walked(fitted(exact(100)))
    slow, fast = (integrated_time(u[100:], quiet=True, tol=0).max() for u in (one, several))
    assert fast < 0.6 * slow
    u = several[100:].reshape(-1, N)
    assert u[:, ::2].mean(axis=0) == pytest.approx([0.0, 0.0], abs=0.08)
    assert np.mean(u[:, ::2] ** 2) == pytest.approx(1.0, abs=0.06)
    away = u[:, 1::2] - BEND * u[:, ::2] ** 2
    assert np.std(away) == pytest.approx(THIN, rel=0.05)


def test_a_mixture_of_the_wrong_place_changes_no_distribution():
    far = fitted(exact(100) + np.array([0.5, -0.5, -0.5, 0.5]))
    u = walked(far, steps=4000)[500:].reshape(-1, N)
    assert np.mean(u[:, ::2] ** 2) == pytest.approx(1.0, abs=0.12)
    assert np.std(u[:, 1::2] - BEND * u[:, ::2] ** 2) == pytest.approx(THIN, rel=0.08)
