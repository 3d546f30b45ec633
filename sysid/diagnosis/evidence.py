"""A campaign as a diagnosis sees it: measured harmonics, and models simulated in the same ones."""

from dataclasses import dataclass, replace
from typing import Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from sysid.data.loops import Loops
from sysid.diagnosis.prototypes import Magnitudes, magnitudes
from sysid.effects.base import AbstractLawEffect, Changes, ValveParts
from sysid.effects.base import Parts as ForceParts
from sysid.identification.fit import conditions
from sysid.likelihood.compress import HarmonicBasis, harmonic_basis
from sysid.likelihood.discrepancy import Parts, covariance_parts
from sysid.models.base import AbstractInnerValve
from sysid.models.coordinates import AbstractCoordinates
from sysid.models.damper import Damper
from sysid.models.simulate import simulate
from sysid.motion.history import with_history
from sysid.motion.motion import Motion, loop_motion

POINTS: Final = 72
"""Points a loop is simulated on, if its model needs no more (`Family.points`); forces are compared
in harmonics, which do not."""
BATCH: Final = 32
"""Loops are filled up to a multiple of this, so that campaigns share compiled programs."""
FEWEST_CONDITIONS: Final = 4
"""Amplitudes and frequencies below which each is held out in parts, by temperature."""
WARMER: Final = 5.0
"""K, range of temperatures from which a condition has parts."""
SHARP: Final = 6
TRUST: Final = 10.0
"""A test whose harmonics above the sixth exceed its noise by more than this factor (a structure
that rings, say) would outweigh all others, for Σ has no such errors.  It counts as noisier."""


@dataclass(frozen=True)
class Evidence:
    """Measured loops in harmonics, and what is needed to simulate them.

    Attributes:
        loops: L tests.
        motion: Of the tests, filled up to a multiple of `BATCH` by repeats of the last.
        force: [L, P] N, measured, on the points that are simulated.
        measured: [L, m] N, harmonics of the measured force.
        basis: Of the measured loops.
        columns: [P, m], from simulated loops to harmonics.
        parts: What the discrepancy covariance is made of.
        condition: [L] number of the condition that a test is held out with (`held_together`).
        peak: [L] N, max|F|.
        size: Magnitudes of the campaign.
        history: The order of the tests is known.
    """

    loops: Loops
    motion: Motion
    force: Float[np.ndarray, "loop point"]
    measured: Float[np.ndarray, "loop m"]
    basis: HarmonicBasis
    columns: Float[Array, "point m"]
    parts: Parts
    condition: Int[np.ndarray, " loop"]
    peak: Float[np.ndarray, " loop"]
    size: Magnitudes
    history: bool

    @property
    def tests(self) -> int:
        """L."""
        return len(self.loops.ids)

    @property
    def ordered_condition(self) -> Int[np.ndarray, " loop"]:
        """[L] number of the condition by amplitude, frequency, temperature, as tests may come."""
        numbers = np.unique(self.condition)
        warm = np.nan_to_num(self.loops.temperature)
        amplitude, frequency, temperature = (
            np.array([z[self.condition == c].mean() for c in numbers])
            for z in (self.loops.amplitude, self.loops.frequency, warm)
        )
        rank = np.empty(numbers.size, dtype=int)
        rank[np.lexsort((temperature, frequency, amplitude))] = np.arange(numbers.size)
        return rank[np.searchsorted(numbers, self.condition)]

    def look(
        self, coordinates: AbstractCoordinates, u: Float[np.ndarray, " n"]
    ) -> tuple[Float[np.ndarray, "loop m"], Float[np.ndarray, "loop m n"]]:
        """Residual (measured minus model) and Jacobian of the model at u."""
        value, jacobian = _look(coordinates, jnp.asarray(u), self.motion, self.columns)
        count = self.tests
        return self.measured - np.asarray(value)[:count], np.asarray(jacobian)[:count]

    def residual(
        self, coordinates: AbstractCoordinates, u: Float[np.ndarray, " n"]
    ) -> Float[np.ndarray, "loop m"]:
        """Residual alone."""
        value = _value(coordinates, jnp.asarray(u), self.motion, self.columns)
        return self.measured - np.asarray(value)[: self.tests]

    def signature(self, damper: Damper) -> Float[np.ndarray, "loop m"]:
        """[F − F without the last effect]/its size, N per unit of the size."""
        return np.asarray(_signature(damper, self.motion, self.columns))[: self.tests]

    def beside(self, damper: Damper, residual: Float[np.ndarray, "loop m"]) -> "Evidence":
        """The same, with rig errors and errors of the laws acting on the force that a model has.

        Args:
            damper: The model, for the directions in which its laws may be wrong.
            residual: [L, m] N, what it leaves.
        """
        force = self.measured - residual
        parts = covariance_parts(self.loops, self.basis, force)
        bent = np.asarray(_law_directions(damper, self.motion, self.columns))[:, : self.tests]
        relative = np.sqrt(
            np.mean(np.mean(residual**2, axis=1) / np.mean(self.measured**2, axis=1))
        )
        laws = np.concatenate([force[None], bent])
        warmth = np.zeros((0, 0))
        if damper.valve.thermal:
            warmth = np.asarray(_warmth(damper, self.motion, self.columns))[: self.tests]
        sharp = np.sqrt(np.mean(residual[:, parts.order > SHARP] ** 2, axis=1))
        noise = parts.noise * np.maximum(1.0, sharp / (TRUST * parts.noise))
        error = float(relative)
        more = replace(parts, warmth=warmth, laws=laws, error=error, noise=noise)
        return replace(self, parts=more)

    def energy(self, residual: Float[np.ndarray, "loop m"]) -> float:
        """Σ ‖r‖²/max|F|² over tests."""
        return float(np.sum(np.sum(residual**2, axis=1) / self.peak**2))

    def errors(self, damper: Damper, *, offset: bool = True) -> Float[np.ndarray, " loop"]:
        """RMSE/max|F| of each test in free run, on the points that are simulated.

        Args:
            damper: The model.
            offset: Count what is constant through a test; else its shape alone.
        """
        residual = self.force - np.asarray(simulate(damper, self.motion))[: self.tests]
        if not offset:
            residual = residual - residual.mean(axis=1, keepdims=True)
        return np.sqrt(np.mean(residual**2, axis=1)) / self.peak


def _on_points(loops: Loops, points: int) -> Loops:
    """The same loops on fewer phase points, by their harmonics."""

    def fewer(z: np.ndarray) -> np.ndarray:
        lines = np.fft.rfft(z, axis=-1)[:, : points // 2 + 1] * (points / z.shape[-1])
        lines[:, -1] = 2.0 * lines[:, -1].real
        return np.fft.irfft(lines, points, axis=-1)

    return replace(
        loops,
        displacement=fewer(loops.displacement),
        velocity=fewer(loops.velocity),
        acceleration=fewer(loops.acceleration),
        force=fewer(loops.force),
        deviations=(),
        displacement_deviations=(),
    )


def held_together(loops: Loops) -> Int[np.ndarray, " loop"]:
    """Number of the condition of each test: its amplitude and frequency, with all currents.

    A sweep over temperature has few of these, and what predicts the one from the other is
    extrapolated.  There each is cut into parts from cold to warm, with all their currents, so that
    a test is predicted from warmer and from colder ones, and from the other excitations.

    Args:
        loops: L tests.
    """
    number = conditions(loops)
    count = int(number.max()) + 1
    if count >= FEWEST_CONDITIONS or np.isnan(loops.temperature).any():
        return number
    parts = -(-2 * FEWEST_CONDITIONS // count)
    cut = np.empty_like(number)
    for k in range(count):
        here = np.flatnonzero(number == k)
        warm = loops.temperature[here]
        if np.ptp(warm) < WARMER:
            cut[here] = k * parts
            continue
        share = (warm - warm.min()) / np.ptp(warm)
        cut[here] = k * parts + np.minimum((share * parts).astype(int), parts - 1)
    return np.unique(cut, return_inverse=True)[1]


def gather(loops: Loops, run_order: np.ndarray | None = None, points: int = POINTS) -> Evidence:
    """Prepare loops for a diagnosis.

    Args:
        loops: L tests on J phase points, J even.
        run_order: [L] position of each test in the campaign, if known.
        points: To simulate on, where the loops have as many.
    """
    measured = loops.force.shape[1]
    basis = harmonic_basis(measured, min(15, measured // 2 - 1))
    plain = loops
    if measured > points and measured % points:
        plain = _on_points(loops, points)
    simulated = plain.force.shape[1]
    stride = max(simulated // points, 1)
    motion = loop_motion(plain)
    if run_order is not None:
        motion = with_history(motion, run_order=np.asarray(run_order, dtype=float))
    count = len(loops.ids)
    filled = np.minimum(np.arange(-(-count // BATCH) * BATCH), count - 1)

    def thin(z: Array) -> Array:
        return z[filled][:, ::stride] if z.shape[-1] == simulated else z[filled]

    count_simulated = simulated // stride
    columns = harmonic_basis(count_simulated, int(basis.order.max())).columns / count_simulated
    return Evidence(
        loops=loops,
        motion=jax.tree.map(thin, motion),
        force=plain.force[:, ::stride],
        measured=basis.compress(loops.force),
        basis=basis,
        columns=jnp.asarray(columns),
        parts=covariance_parts(loops, basis),
        condition=held_together(loops),
        peak=np.abs(loops.force).max(axis=1),
        size=magnitudes(loops),
        history=run_order is not None,
    )


@eqx.filter_jit
def _look(
    coordinates: AbstractCoordinates, u: Array, motion: Motion, columns: Array
) -> tuple[Array, Array]:
    value, push = jax.linearize(lambda z: coordinates.valve(z).force(motion) @ columns, u)
    return value, jnp.moveaxis(jax.vmap(push)(jnp.eye(u.size)), 0, 2)


@eqx.filter_jit
def _value(coordinates: AbstractCoordinates, u: Array, motion: Motion, columns: Array) -> Array:
    return coordinates.valve(u).force(motion) @ columns


@eqx.filter_jit
def _signature(damper: Damper, motion: Motion, columns: Array) -> Array:
    *others, effect = damper.effects
    symbol = effect.facts.size
    size = getattr(effect, symbol)
    none = eqx.tree_at(lambda e: getattr(e, symbol), effect, jnp.zeros_like(size))
    absent = Damper(damper.valve, (*others, none))
    return (damper.force(motion) - absent.force(motion)) @ columns / size


@eqx.filter_jit
def _warmth(damper: Damper, motion: Motion, columns: Array) -> Array:
    """[L, m] N/K, change of the force if all of a test were warmer."""

    def at(temperature: Array) -> Array:
        return damper.force(eqx.tree_at(lambda m: m.temperature, motion, temperature)) @ columns

    t = motion.temperature
    return jax.jvp(at, (t,), (jnp.ones_like(t),))[1]


WIDER: Final = 0.1
"""A hundred per cent of loop width, in parts of the peak velocity: the order of measured loops."""


@eqx.filter_jit
def _law_directions(damper: Damper, motion: Motion, columns: Array) -> Array:
    """[2, L, m] N: the loop made wider by its own width, and its force stretched over velocity.

    A valve whose width is that of a spring is given another spring and another viscosity: it goes
    by displacement and velocity, and neither can be stretched without the other.
    """
    if isinstance(damper.valve, AbstractInnerValve):
        return _laws_inside(damper, motion, columns)

    def through(velocity: Array) -> Array:
        return damper.force(eqx.tree_at(lambda m: m.velocity, motion, velocity)) @ columns

    v = motion.velocity
    shift = WIDER * motion.peak_velocity * motion.acceleration_sign
    wider = jax.jvp(through, (v,), (shift,))[1]
    steeper = jax.jvp(through, (v,), (v,))[1]
    return jnp.stack([wider, steeper])


class _OtherLaws(AbstractLawEffect):
    """A valve that is softer and more viscous than it is taken to be, each in parts of itself."""

    softer: Array
    thicker: Array

    def parts(self, motion: Motion, valve: ValveParts) -> ForceParts:
        """The parts of that valve."""
        changes = Changes(stiffness=1.0 / (1.0 + self.softer), viscous=1.0 + self.thicker)
        return valve.changed(motion, changes)


def _laws_inside(damper: Damper, motion: Motion, columns: Array) -> Array:
    """The same for a valve with a spring, whose loop is as wide as that is soft."""

    def through(softer: Array, thicker: Array) -> Array:
        changed = (_OtherLaws(softer, thicker), *damper.effects)
        return Damper(damper.valve, changed).force(motion) @ columns

    one, none = jnp.ones(()), jnp.zeros(())
    _, push = jax.linearize(through, none, none)
    return jnp.stack([push(one, none), push(none, one)])
