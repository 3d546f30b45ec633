"""What is to be fitted: measured force, the motion behind it, how much each test counts."""

from collections.abc import Sequence
from typing import Final, Literal, get_args

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.arrays import Signal
from sysid.data.loops import Loops
from sysid.data.record import Record
from sysid.errors import FitError
from sysid.models.coordinates import Reference, reference_current
from sysid.motion.motion import Motion, loop_motion
from sysid.motion.time_motion import time_motion

Weights = Literal["paper", "peak", "noise"]
WEIGHTS: Final[tuple[Weights, ...]] = get_args(Weights)

SEGMENTS: Final = 10
"""Consecutive parts of a record that is not periodic; its length is a multiple of this."""


class Problem(eqx.Module):
    """Least squares over tests: U = Σ_l w_l² Σ_j (F_lj − F̂_lj)² (W11 Eq. 11 with w = 1).

    Attributes:
        motion: [L, n].
        force: [L, n] N, measured.
        weight: [L, n] 1/N or 1; 0 marks padding.
        reference: The campaign's magnitudes.
    """

    motion: Motion
    force: Signal
    weight: Signal
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
        raise _no_current(unknown)
    motion = loop_motion(loops)
    return Problem(
        motion=motion,
        force=jnp.asarray(loops.force),
        weight=jnp.asarray(
            np.broadcast_to(test_weights(loops, weights)[:, None], loops.force.shape)
        ),
        reference=_reference(loops.force, motion),
    )


def record_problem(
    records: Sequence[Record], weights: Weights = "paper", *, reference: Reference | None = None
) -> Problem:
    """The problem of fitting tests that are not sinusoidal, each on its own time grid.

    Shorter records are filled up with weightless points.  Displacement is taken from the mean of
    the record, velocity and acceleration from displacement.

    Args:
        records: R tests.
        weights: "paper" or "peak".
        reference: The magnitudes of loops that are fitted beside; from the records if None.

    Raises:
        FitError: A current is unknown, or weights by noise are asked.
    """
    if weights == "noise":
        raise FitError(
            "has no noise floor, since it does not repeat",
            where=f"test {records[0].id}",
            advice="Use --weights peak",
        )
    motions = [record_motion(record) for record in records]
    n = SEGMENTS * -(-max(record.force.size for record in records) // SEGMENTS)

    def stack(rows: Sequence[np.ndarray | Array], fill: str = "edge") -> np.ndarray:
        padded = [np.pad(np.asarray(z), (0, n - z.shape[0]), mode=fill) for z in rows]  # pyright: ignore[reportCallIssue, reportArgumentType]
        return np.stack(padded)

    peak = [np.abs(record.force).max() if weights == "peak" else 1.0 for record in records]
    ones = [np.full(r.force.size, 1.0 / p) for r, p in zip(records, peak, strict=True)]
    motion = jax.tree.map(lambda *rows: stack(rows), *motions)
    force = stack([record.force for record in records])
    return Problem(
        motion=motion,
        force=force,
        weight=stack(ones, "constant"),
        reference=reference or _reference(force, motion),
    )


def record_motion(record: Record) -> Motion:
    """The motion of a whole record, [n], displacement relative to its mean.

    Raises:
        FitError: The current is not known.
    """
    current = record.current if record.current is not None else record.nominal.current
    if current is None:
        raise _no_current([record.id])
    known = record.temperature if record.temperature is not None else record.nominal.temperature
    return time_motion(
        record.time,
        record.displacement - record.displacement.mean(),
        current=current,
        temperature=known,
    )


def _no_current(ids: Sequence[str]) -> FitError:
    return FitError(
        "the current is not known",
        where=f"test {ids[0]}" + (f" and {len(ids) - 1} more" if len(ids) > 1 else ""),
        advice="Give it as a column, in tests.csv, in the file name or under [constants]",
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


def _reference(force: Array | np.ndarray, motion: Motion) -> Reference:
    """RMS force, largest peak velocity, largest current (1 A if none) and largest travel."""
    return Reference(
        force=float(np.sqrt(np.mean(np.square(force)))),
        speed=float(np.max(motion.peak_velocity)),
        current=reference_current(np.asarray(motion.current)),
        length=float(np.abs(motion.displacement).max()),
    )


def weighted(
    excess: Float[Array, "*test n"],
    weight: Float[Array | np.ndarray, "*test n"],
    *,
    statics_free: bool,
) -> Float[Array, "*test n"]:
    """Weighted residuals of tests.

    A static force of each test, where it is free, is linear in the residuals and in no other
    parameter: at its best value it leaves them about their mean.

    Args:
        excess: N, simulated minus measured force.
        weight: Of each point.
        statics_free: Each test has a static force of its own.
    """
    weight = jnp.asarray(weight)
    if not statics_free:
        return weight * excess
    square = weight**2
    total = jnp.sum(square, axis=-1, keepdims=True)
    static = jnp.sum(square * excess, axis=-1, keepdims=True) / jnp.where(total > 0.0, total, 1.0)
    return weight * (excess - static)


def take_points(problem: Problem, index: np.ndarray) -> Problem:
    """The same tests on some of their points, weighted so that the cost keeps its scale.

    Args:
        problem: Tests on grids of n points.
        index: [k] points to keep.
    """
    n = problem.force.shape[1]

    def take(z: Signal) -> np.ndarray:
        z = np.asarray(z)
        return z[:, index] if z.shape[1] == n else z

    weight = np.sqrt(n / index.size) * take(problem.weight)
    motion = jax.tree.map(take, problem.motion)
    return Problem(motion, take(problem.force), weight, problem.reference)


def take_tests(problem: Problem, index: np.ndarray) -> Problem:
    """The same problem on some of its tests.

    Args:
        problem: L tests.
        index: [k] tests to keep, in the wanted order; repeats are allowed.
    """
    tests = (problem.motion, problem.force, problem.weight)
    motion, force, weight = jax.tree.map(lambda z: np.asarray(z)[index], tests)
    return Problem(motion, force, weight, problem.reference)
