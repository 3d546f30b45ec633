"""What is to be fitted: measured force, the motion behind it, how much each test counts."""

from typing import Literal, get_args

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.data.loops import Loops
from sysid.errors import FitError
from sysid.models.coordinates import Reference
from sysid.models.motion import Motion, loop_motion

Weights = Literal["paper", "peak", "noise"]
WEIGHTS: tuple[Weights, ...] = get_args(Weights)


class Problem(eqx.Module):
    """Least squares over tests: U = Σ_l w_l² Σ_j (F_lj − F̂_lj)² (W11 Eq. 11 with w = 1).

    Attributes:
        motion: [L, n].
        force: [L, n] N, measured.
        weight: [L, n] 1/N or 1; 0 marks padding.
        reference: The campaign's magnitudes.
    """

    motion: Motion
    force: Float[Array, "loop n"]
    weight: Float[Array, "loop n"]
    reference: Reference

    @property
    def tests(self) -> int:
        """Number of tests, L."""
        return self.force.shape[0]


def loop_problem(loops: Loops, weights: Weights = "paper") -> Problem:
    """The problem of fitting steady loops.

    Args:
        loops: L tests.
        weights: "paper" every point alike (Eq. 11 as printed), "peak" each test divided by its
            max|F|, "noise" each test divided by its noise floor.

    Raises:
        FitError: A current is unknown, or weights by noise are asked of single cycles.
    """
    unknown = [name for name, i in zip(loops.ids, loops.current, strict=True) if not np.isfinite(i)]
    if unknown:
        raise FitError(
            "the current is not known",
            where=f"test {unknown[0]}" + (f" and {len(unknown) - 1} more" if unknown[1:] else ""),
            advice="Give it as a column, in tests.csv, in the file name or under [constants]",
        )
    return Problem(
        motion=loop_motion(loops),
        force=jnp.asarray(loops.force),
        weight=jnp.asarray(
            np.broadcast_to(test_weights(loops, weights)[:, None], loops.force.shape)
        ),
        reference=reference_of(loops),
    )


def test_weights(loops: Loops, weights: Weights) -> np.ndarray:
    """Weight w_l of each test, [L].

    Raises:
        FitError: "noise" is asked and a test has no noise floor.
    """
    if weights == "paper":
        return np.ones(len(loops.ids))
    if weights == "peak":
        return 1.0 / np.abs(loops.force).max(axis=1)
    usable = np.isfinite(loops.noise_floor) & (loops.noise_floor > 0.0)
    if not usable.all():
        raise FitError(
            "has no noise floor, since it has a single cycle or no scatter at all",
            where=f"test {loops.ids[int(np.argmin(usable))]}",
            advice="Leave it out with --exclude or use --weights peak",
        )
    return 1.0 / loops.noise_floor


def reference_of(loops: Loops) -> Reference:
    """RMS force, largest peak velocity and largest current of a campaign."""
    current = float(np.abs(loops.current).max())
    return Reference(
        force=float(np.sqrt(np.mean(loops.force**2))),
        speed=float(loops.peak_velocity.max()),
        current=current if current > 0.0 else 1.0,
    )


def take_points(problem: Problem, index: np.ndarray) -> Problem:
    """The same tests on some of their points, weighted so that the cost keeps its scale.

    Args:
        problem: Tests on grids of n points.
        index: Points to keep.
    """
    n = problem.force.shape[1]
    motion = jax.tree.map(lambda z: z[:, index] if z.shape[1] == n else z, problem.motion)
    weight = np.sqrt(n / index.size) * problem.weight[:, index]
    return Problem(motion, problem.force[:, index], weight, problem.reference)


def take_tests(problem: Problem, index: np.ndarray) -> Problem:
    """The same problem on some of its tests.

    Args:
        problem: L tests.
        index: Tests to keep, in the wanted order; repeats are allowed.
    """
    motion = jax.tree.map(lambda z: z[index], problem.motion)
    return Problem(motion, problem.force[index], problem.weight[index], problem.reference)
