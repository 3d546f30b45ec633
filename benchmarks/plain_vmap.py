"""The solver of single fits under `vmap` over a whole fleet: what a batch gives without more."""

from collections.abc import Sequence
from typing import Final, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.data.loops import Loops
from sysid.identification.features import loop_features
from sysid.identification.levenberg_marquardt import Descent, descend
from sysid.identification.multistart import BLOCK, SPREADS, WAVE, in_blocks
from sysid.identification.problem import Problem, loop_problem
from sysid.identification.starts.generalized import generalized_start
from sysid.models.generalized_coordinates import GeneralizedCoordinates

M = TypeVar("M", bound=eqx.Module)
TOGETHER: Final = 32
"""Dampers of a batch, each with eight starts."""


def fit_vmapped(fleet: Sequence[Loops]) -> Float[np.ndarray, " damper"]:
    """Cost of every damper, N²: eight starts of each, then a last descent from the best.

    Args:
        fleet: A multiple of `TOGETHER` dampers with tests of one plan.
    """
    return np.concatenate([
        _fit(fleet[k : k + TOGETHER]) for k in range(0, len(fleet), TOGETHER)
    ])  # fmt: skip


def _fit(fleet: Sequence[Loops]) -> np.ndarray:
    problems = [loop_problem(loops) for loops in fleet]
    coordinates = [GeneralizedCoordinates(p.reference, "asymmetric") for p in problems]
    first = np.stack([
        generalized_start(loop_features(loops), one)
        for loops, one in zip(fleet, coordinates, strict=True)
    ])  # fmt: skip
    scatter = SPREADS[0] * np.random.default_rng(0).standard_normal((WAVE, first.shape[1]))
    scatter[0] = 0.0
    parts = _stacked([in_blocks(problem, BLOCK) for problem in problems])
    maps = _stacked(coordinates)
    wave = _wave(maps, parts, jnp.asarray(first[:, None] + scatter))
    cost = np.asarray(wave.cost)
    best = np.where(np.isfinite(cost), cost, np.inf).argmin(axis=1)
    start = np.asarray(wave.u)[np.arange(len(fleet)), best]
    last = _last(maps, parts, jnp.asarray(start))
    scale = np.array([float(np.sum(loops.force**2)) for loops in fleet])
    return np.asarray(last.cost) * scale


def _stacked(modules: list[M]) -> M:
    return jax.tree.map(lambda *z: np.stack([np.asarray(y) for y in z]), *modules)


@eqx.filter_jit
def _wave(
    coordinates: GeneralizedCoordinates, parts: Problem, starts: Float[Array, "damper start n"]
) -> Descent:
    def one(maps: GeneralizedCoordinates, part: Problem, u: Array) -> Descent:
        return jax.vmap(
            lambda z: descend(maps, (part,), z, tolerance=1e-4, max_steps=60, trust=1e2)
        )(u)

    return eqx.filter_vmap(one)(coordinates, parts, starts)


@eqx.filter_jit
def _last(
    coordinates: GeneralizedCoordinates, parts: Problem, start: Float[Array, "damper n"]
) -> Descent:
    def one(maps: GeneralizedCoordinates, part: Problem, u: Array) -> Descent:
        return descend(maps, (part,), u, tolerance=1e-8, max_steps=200, trust=1e8)

    return eqx.filter_vmap(one)(coordinates, parts, start)
