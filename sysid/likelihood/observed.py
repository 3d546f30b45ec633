"""Measured loops in harmonics, and models simulated in the same ones."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final, Self

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.data.loops import Loops
from sysid.likelihood.batches import BATCH, by_batches, in_batches
from sysid.likelihood.compress import HARMONICS, HarmonicBasis, harmonic_basis
from sysid.likelihood.discrepancy_parts import Parts, covariance_parts, rate_of
from sysid.likelihood.kernel import WARM, kernel_of
from sysid.likelihood.law_directions import (
    change_with_warmth,
    force_by_laws,
    law_directions,
    yield_direction,
)
from sysid.models.coordinates import AbstractCoordinates
from sysid.models.damper import Damper
from sysid.motion.history import RunHistory, with_history
from sysid.motion.motion import Motion, loop_motion

POINTS: Final = 360
"""Points a loop is simulated on, where as many are measured and its model does not say otherwise
(`Family.points_for`).  Forces are compared in few harmonics, but on few points what jumps at a
reversal is folded into them: with 72, a play of 16 µm came out as 14.3 ± 0.3 µm, with 360 as
16.4 µm."""
SHARP: Final = 6
TRUST: Final = 10.0
"""A test whose harmonics above the sixth exceed its noise by more than this factor (a structure
that rings, say) would outweigh all others, for Σ has no such errors.  It counts as noisier."""


@dataclass(frozen=True)
class Observed:
    """Measured loops in harmonics, and what is needed to simulate them.

    Attributes:
        loops: L tests.
        motion: Of the tests, filled up to a multiple of `BATCH` by repeats of the last.
        force: [L, P] N, measured, on the points that are simulated.
        measured: [L, m] N, harmonics of the measured force, as if delays of the force channel
            acted to first order (`late`).
        basis: Of the measured loops.
        columns: [P, m], from simulated loops to harmonics.
        parts: What the discrepancy covariance is made of.
        bend: [L, m] N, what delays beyond the first order add to `measured` in the record; zeros
            until delays are known.
    """

    loops: Loops
    motion: Motion
    force: Float[np.ndarray, "loop point"]
    measured: Float[np.ndarray, "loop m"]
    basis: HarmonicBasis
    columns: Float[Array, "point m"]
    parts: Parts
    bend: Float[np.ndarray, "loop m"]

    @property
    def tests(self) -> int:
        """L."""
        return len(self.loops.ids)

    @cached_property
    def batches(self) -> tuple[Motion, ...]:
        """The motion, `in_batches`."""
        return in_batches(self.motion)

    def of_tests(self, program: Callable[[Motion], Any]) -> Any:
        """What a compiled program makes of the tests, `by_batches`.

        Args:
            program: Motion of a batch → arrays with one row a test.

        Returns:
            The same arrays of L rows.
        """
        return jax.tree.map(lambda z: z[: self.tests], by_batches(program, self.batches))

    def look(
        self, coordinates: AbstractCoordinates, u: Float[np.ndarray, " n"]
    ) -> tuple[Float[np.ndarray, "loop m"], Float[np.ndarray, "loop m n"]]:
        """Residual (measured minus model) and Jacobian of the model at u."""
        z = jnp.asarray(u)
        value, jacobian = self.of_tests(lambda some: _look(coordinates, z, some, self.columns))
        return self.measured - value, jacobian

    def residual(
        self, coordinates: AbstractCoordinates, u: Float[np.ndarray, " n"]
    ) -> Float[np.ndarray, "loop m"]:
        """Residual alone."""
        z = jnp.asarray(u)
        return self.measured - self.of_tests(
            lambda some: _value(coordinates, z, some, self.columns)
        )

    def relative(
        self, residual: Float[np.ndarray, "loop m"], *, statics_free: bool = False
    ) -> float:
        """RMS of a residual, parts of the RMS force of each test.

        Args:
            residual: [L, m] N.
            statics_free: Each test has a static force beside the model
                (`AbstractCoordinates.statics_free`), which counts neither as left nor as force.
        """
        first = int(statics_free)
        left, force = residual[:, first:], self.measured[:, first:]
        squares = np.mean(left**2, axis=1) / np.mean(force**2, axis=1)
        return float(np.sqrt(np.mean(squares)))

    def rate_of(self, residual: Float[np.ndarray, "loop m"]) -> Float[np.ndarray, "loop m"]:
        """Time derivative of the force of a model, N/s, [L, m].

        Args:
            residual: [L, m] N, what it leaves.
        """
        return rate_of(self.measured - residual, self.loops, self.basis)

    def beside(
        self,
        damper: Damper,
        residual: Float[np.ndarray, "loop m"],
        *,
        apart: bool = False,
        statics_free: bool = False,
    ) -> Self:
        """The same, with rig errors and errors of the laws acting on the force that a model has.

        How smooth errors of the laws are over conditions (K_c) stays as it is, but for temperature
        where only now a valve has laws of that.

        Args:
            damper: The model, for the directions in which its laws may be wrong.
            residual: [L, m] N, what it leaves.
            apart: The yield force errs without the viscous one, where the valve has a law of its
                own for it.  Intervals ask for it; a diagnosis does not, for there laws that may
                err in more ways hide the cause that is sought.
            statics_free: Each test has a static force beside the model, as for `relative`.
        """
        force = self.measured - residual
        parts = covariance_parts(self.loops, self.basis, force)
        bent = self.of_tests(
            lambda some: jnp.moveaxis(law_directions(damper, some, self.columns), 1, 0)
        )
        scale = force
        if apart and damper.valve.laws.yielding:
            scale = self.of_tests(lambda some: yield_direction(damper, some, self.columns))
        elif damper.effects:
            scale = self.of_tests(lambda some: force_by_laws(damper, some, self.columns))
        laws = np.concatenate([scale[None], np.moveaxis(bent, 1, 0)])
        sharp = np.sqrt(np.mean(residual[:, parts.order > SHARP] ** 2, axis=1))
        noise = parts.noise * np.maximum(1.0, sharp / (TRUST * parts.noise))
        warmth, kernel, lengths = np.zeros((0, 0)), self.parts.kernel, self.parts.lengths
        if damper.valve.thermal:
            if not np.isfinite(lengths[-1]):
                lengths = (*lengths[:-1], WARM)
                kernel = kernel_of(self.loops, lengths)
            warmth = self.of_tests(lambda some: change_with_warmth(damper, some, self.columns))
        more = replace(
            parts,
            warmth=warmth,
            laws=laws,
            error=self.relative(residual, statics_free=statics_free),
            noise=noise,
            kernel=kernel,
            lengths=lengths,
        )
        return replace(self, parts=more)


def _on_points(loops: Loops, points: int) -> Loops:
    """The same loops on other phase points, fewer or more, by their harmonics."""

    def other(z: np.ndarray) -> np.ndarray:
        lines = np.fft.rfft(z, axis=-1)[:, : points // 2 + 1] * (points / z.shape[-1])
        # the cosine at the end of the band: both halves of it fold together, or part
        lines[:, -1] = lines[:, -1].real * (2.0 if points < z.shape[-1] else 0.5)
        return np.fft.irfft(lines, points, axis=-1)

    return replace(
        loops,
        displacement=other(loops.displacement),
        velocity=other(loops.velocity),
        acceleration=other(loops.acceleration),
        force=other(loops.force),
        deviations=(),
        displacement_deviations=(),
    )


def observe(
    loops: Loops,
    history: RunHistory | None = None,
    points: int | None = None,
    harmonics: int = HARMONICS,
) -> Observed:
    """Compress loops to harmonics.

    Args:
        loops: L tests on J phase points, J even.
        history: Of the L tests, if their order is known.
        points: To simulate on; `POINTS` where the loops have as many, if not given.
        harmonics: To compare, where the points carry as many.
    """
    measured = loops.force.shape[1]
    points = min(POINTS, measured) if points is None else points
    basis = harmonic_basis(measured, min(harmonics, measured // 2 - 1, points // 2 - 1))
    plain = loops
    if measured < points or measured % points:
        plain = _on_points(loops, points)
    simulated = plain.force.shape[1]
    stride = max(simulated // points, 1)
    motion = with_history(loop_motion(plain), history)
    count = len(loops.ids)
    filled = np.minimum(np.arange(-(-count // BATCH) * BATCH), count - 1)

    def thin(z: Array) -> Array:
        return z[filled][:, ::stride] if z.shape[-1] == simulated else z[filled]

    count_simulated = simulated // stride
    columns = harmonic_basis(count_simulated, int(basis.order.max())).columns / count_simulated
    recorded = basis.compress(loops.force)
    return Observed(
        loops=loops,
        motion=jax.tree.map(thin, motion),
        force=plain.force[:, ::stride],
        measured=recorded,
        basis=basis,
        columns=jnp.asarray(columns),
        parts=covariance_parts(loops, basis),
        bend=np.zeros_like(recorded),
    )


@eqx.filter_jit
def _look(
    coordinates: AbstractCoordinates, u: Array, motion: Motion, columns: Array
) -> tuple[Array, Array]:
    def along(direction: Array) -> tuple[Array, Array]:
        """Value, and its change along a direction: quicker than what `jax.linearize` makes."""
        return jax.jvp(lambda z: coordinates.valve(z).force(motion) @ columns, (u,), (direction,))

    return jax.vmap(along, out_axes=(None, 2))(jnp.eye(u.size))


@eqx.filter_jit
def _value(coordinates: AbstractCoordinates, u: Array, motion: Motion, columns: Array) -> Array:
    return coordinates.valve(u).force(motion) @ columns
