r"""Draws of what a model's laws, and a rig, add to the force of a test: the rest of Σ.

Σ (`likelihood/discrepancy.py`) says how large errors of the laws are and how smoothly they go over
amplitude, frequency and current.  So what a campaign's residuals r tell of them in its tests tells
of them at other conditions *, too.  With Σ = Σ_s + Σ_r (laws; rig and noise), for every draw of the
parameters,

    e* | r  ~  N( Σ_s,*o Σ⁻¹ r,  Σ_s,** − Σ_s,*o Σ⁻¹ Σ_s,o* )

At a condition of the campaign this is what its own residual leaves open, near one little more, and
far from all of them the whole prior size of such errors.  Nothing of that size is factorised: a
draw (e*, e_o) from the prior, and one of rig and noise, are corrected by what they miss,

    e* + Σ_s,*o Σ⁻¹ ( r − e_o − rig − noise )

An error is written as Σ_k α_k D_k, amplitudes α of a test times directions D at its points.

Source:
    The correction: Journel and Huijbregts, Mining Geostatistics (1978), "conditioning by kriging";
    in geostatistics after Matheron.
"""

from dataclasses import dataclass
from typing import Any, Final

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float
from scipy.optimize import nnls

from sysid.likelihood.compress import harmonic_basis
from sysid.likelihood.discrepancy import Sizes
from sysid.likelihood.discrepancy_parts import (
    LAWS,
    ROLL_OFF,
    covariance_parts,
)
from sysid.likelihood.kernel import kernel_between, places_of
from sysid.likelihood.law_directions import change_with_warmth, law_directions, yield_direction
from sysid.likelihood.observed import Observed
from sysid.models.coordinates import AbstractCoordinates, reference_current, valve_at
from sysid.models.damper import Damper
from sysid.models.simulate import simulate
from sysid.motion.motion import Motion
from sysid.uncertainty.error_model import ErrorModel

SMALLEST: Final = 1e-12
"""Eigenvalues of K_c below this part of its largest are rounding."""
SAME: Final = 0.01
"""Conditions nearer than this part of each quantity are one: no rig repeats them better."""


@dataclass(frozen=True)
class LoopErrors:
    """Draws of what is added to the force of L steady loops.

    Attributes:
        amplitudes: [D, L, k], in parts of `directions`.
        directions: [L, k, P] N for an amplitude of one.
        white: [L] N, standard deviation of noise from point to point.
    """

    amplitudes: Float[np.ndarray, "draw loop k"]
    directions: Float[np.ndarray, "loop k point"]
    white: Float[np.ndarray, " loop"]

    def at(self, some: slice, rng: np.random.Generator) -> Float[np.ndarray, "draw some point"]:
        """Of some of the loops, N."""
        smooth = np.einsum(
            "dlk,lkp->dlp", self.amplitudes[:, some], self.directions[some], optimize=True
        )
        white = self.white[some, None]
        return smooth + white * rng.standard_normal(smooth.shape) if white.any() else smooth


@dataclass(frozen=True)
class Steady:
    """What Σ asks of L steady cycles.

    Attributes:
        motion: [L, P], periodic.
        amplitude: [L] m, of the fundamental.
        frequency: [L] Hz.
        current: [L] A, mean over the cycle.
        temperature: [L] °C, mean over the cycle; NaN where it is not known.
    """

    motion: Motion
    amplitude: Float[np.ndarray, " loop"]
    frequency: Float[np.ndarray, " loop"]
    current: Float[np.ndarray, " loop"]
    temperature: Float[np.ndarray, " loop"]


def steady_cycles(motion: Motion) -> Steady:
    """Amplitude, frequency and current of periodic motions, [L, P]."""
    x = np.asarray(motion.displacement)
    count = len(x)
    return Steady(
        motion=motion,
        amplitude=2.0 * np.abs(np.fft.rfft(x, axis=1)[:, 1]) / x.shape[1],
        frequency=np.array(np.broadcast_to(motion.frequency, (count, 1))[:, 0]),
        current=np.array(np.mean(motion.current, axis=1)),
        temperature=np.array(np.broadcast_to(np.mean(motion.temperature, axis=1), count)),
    )


def has_law_errors(errors: ErrorModel) -> bool:
    """Σ has errors of the model's laws at all: not every likelihood does."""
    return errors.kind == "full"


def law_errors(
    errors: ErrorModel,
    coordinates: AbstractCoordinates[Any],
    residual: Float[np.ndarray, "draw loop m"],
    wanted: Steady,
    rng: np.random.Generator,
) -> LoopErrors:
    """Draw errors of the laws at some conditions, given the residuals of the campaign.

    Args:
        errors: The likelihood, with errors of laws.
        coordinates: Map from u to the model.
        residual: [D, L, m] N, what each draw of the parameters leaves of the campaign.
        wanted: Where.
        rng: Of the draws; one of the errors for each of the parameters.

    Raises:
        ValueError: The likelihood has no errors of laws.
    """
    if not has_law_errors(errors):
        raise ValueError(f"The {errors.kind} likelihood has no errors of laws.")
    parts, sizes, loops = errors.observed.parts, errors.sizes, errors.observed.loops
    old, draws = len(loops.ids), len(residual)
    largest = reference_current(loops.current)
    place = places_of(loops.amplitude, loops.frequency, loops.current, loops.temperature, largest)
    there = places_of(
        wanted.amplitude, wanted.frequency, wanted.current, wanted.temperature, largest
    )
    everywhere = np.concatenate([place, there])
    root = _root(kernel_between(everywhere, everywhere, parts.lengths))
    across = kernel_between(there, place, parts.lengths)
    damper, force = _simulated(errors, coordinates, wanted.motion)
    scale = np.sqrt(np.mean(force**2, axis=1))
    both = np.concatenate([parts.scale, scale])[:, None, None]
    of_harmonic = np.sqrt(_of_harmonics(sizes, parts.order))  # [m]
    of_law = np.array([getattr(sizes, name) for name in LAWS[: len(parts.laws)]])

    def smooth(k: int) -> np.ndarray:
        z = rng.standard_normal((root.shape[1], k * draws))
        return (root @ z).reshape(len(root), k, draws)

    shape = smooth(parts.order.size) * of_harmonic[:, None] * both  # [old + new, m, D]
    laws = smooth(of_law.size) * of_law[:, None]  # [old + new, p, D]
    simulated = shape[:old] + np.einsum("plm,lpd->lmd", parts.laws, laws[:old], optimize=True)
    simulated += _rig_and_noise(errors, draws, rng)
    missed = errors.covariance.weighted(np.moveaxis(residual, 0, 2) - simulated)

    tell = (parts.scale[:, None, None] * missed).reshape(old, -1)
    corrected = of_harmonic[:, None] ** 2 * (across @ tell).reshape(len(there), -1, draws)
    shape = shape[old:] + scale[:, None, None] * corrected
    tell = np.einsum("plm,lmd->lpd", parts.laws, missed, optimize=True).reshape(old, -1)
    laws = laws[old:] + of_law[:, None] ** 2 * (across @ tell).reshape(len(there), -1, draws)

    points = force.shape[1]
    waves = harmonic_basis(points, int(parts.order.max())).columns.T  # [m, P]
    directions = [np.broadcast_to(waves, (len(there), *waves.shape))]
    if of_law.size:
        every = jnp.eye(points)
        bent = np.asarray(law_directions(damper, wanted.motion, every))
        own = damper.valve.laws.yielding  # as Σ of intervals has it: `Observed.beside(apart=True)`
        scale = np.asarray(yield_direction(damper, wanted.motion, every)) if own else force
        directions += [scale[:, None], np.moveaxis(bent, 0, 1)]
    return LoopErrors(
        amplitudes=np.moveaxis(np.concatenate([shape, laws], axis=1), 2, 0),
        directions=np.concatenate(directions, axis=1),
        white=np.zeros(len(there)),
    )


def rig_errors(
    errors: ErrorModel,
    coordinates: AbstractCoordinates[Any],
    wanted: Steady,
    draws: int,
    rng: np.random.Generator,
) -> LoopErrors:
    """Draw errors of the rig, anew for every test, and the noise of a mean of cycles.

    Where each test has a static force of its own beside the model, that is not drawn.

    Args:
        errors: The likelihood.
        coordinates: Map from u to the model.
        wanted: Tests.
        draws: D.
        rng: Of the draws.
    """
    parts, sizes = errors.observed.parts, errors.sizes
    damper, force = _simulated(errors, coordinates, wanted.motion)
    count, points = force.shape
    omega = 2.0 * np.pi * wanted.frequency[:, None]
    order = np.arange(points // 2 + 1)
    lower = np.where(order <= parts.order.max(), 1j * order, 0.0)  # as many as Σ has
    rate = omega * np.fft.irfft(lower * np.fft.rfft(force, axis=1), points, axis=1)
    offset = 0.0 if coordinates.statics_free else sizes.offset
    kinds = [(sizes.gain, force), (offset, np.ones_like(force)), (sizes.delay, rate)]
    if parts.warmth.size:
        warmth = np.asarray(change_with_warmth(damper, wanted.motion, jnp.eye(points)))
        kinds.append((sizes.thermometer, warmth))
    size = np.array([one for one, _ in kinds])
    return LoopErrors(
        amplitudes=size * rng.standard_normal((draws, count, size.size)),
        directions=np.stack([one for _, one in kinds], axis=1),
        white=_noise_in(errors.observed, wanted, np.sqrt(np.mean(force**2, axis=1))),
    )


def _noise_in(
    observed: Observed, wanted: Steady, force: Float[np.ndarray, " loop"]
) -> Float[np.ndarray, " loop"]:
    """N, noise of a point of the mean of as many cycles as the campaign's tests have.

    √(σ₀² + (ε F_rms)²), fitted to all tests: a load cell scatters by newtons, a rig that is excited
    by parts of the force.  At a condition of the campaign, that of its own tests as far as tests
    differ from this law by more than so few cycles tell.
    """
    loops, parts = observed.loops, observed.parts
    own = covariance_parts(loops, observed.basis).noise ** 2 * loops.force.shape[1]
    columns = np.stack([np.ones_like(own), parts.scale**2], axis=1)
    share, _ = nnls(columns / own[:, None], np.ones_like(own))  # relative errors are alike
    law = columns @ share
    found = share[0] + share[1] * force**2
    apart = np.log(own / law)
    chance = 2.0 / (parts.order.size * np.maximum(loops.cycles - 1, 1))
    real = max(float(np.mean(apart**2 - chance)), 0.0)
    own = law * np.exp(apart * real / (real + chance))
    largest = reference_current(loops.current)
    near = np.ones((len(force), len(own)), dtype=bool)
    for here, there, size in (
        (wanted.amplitude, loops.amplitude, loops.amplitude),
        (wanted.frequency, loops.frequency, loops.frequency),
        (wanted.current, loops.current, np.full(len(own), largest)),
    ):
        near &= np.abs(here[:, None] - there) <= SAME * size
    same = near.any(axis=1)
    found[same] = (near @ own)[same] / near.sum(axis=1)[same]
    return np.sqrt(found)


def together(one: LoopErrors, other: LoopErrors) -> LoopErrors:
    """Both added."""
    return LoopErrors(
        amplitudes=np.concatenate([one.amplitudes, other.amplitudes], axis=2),
        directions=np.concatenate([one.directions, other.directions], axis=1),
        white=np.hypot(one.white, other.white),
    )


def _simulated(
    errors: ErrorModel, coordinates: AbstractCoordinates[Any], motion: Motion
) -> tuple[Damper, np.ndarray]:
    """The model that Σ is built at, and its force, [L, P] N."""
    damper = Damper(valve_at(coordinates, jnp.asarray(errors.u)))
    return damper, np.asarray(simulate(damper, motion))


def _of_harmonics(sizes: Sizes, order: np.ndarray) -> np.ndarray:
    """K_p, [m]."""
    size = np.where(order % 2 == 1, sizes.odd, sizes.even)
    return size**2 / (1.0 + (order / ROLL_OFF) ** 4)


def _rig_and_noise(errors: ErrorModel, draws: int, rng: np.random.Generator) -> np.ndarray:
    """[L, m, D] N, in the harmonics of the campaign's own tests."""
    parts, sizes = errors.observed.parts, errors.sizes
    count, m = parts.force.shape
    found = parts.noise[:, None, None] * rng.standard_normal((count, m, draws))
    found[:, 0] += sizes.offset * rng.standard_normal((count, draws))
    for size, shape in (
        (sizes.gain, parts.force), (sizes.delay, parts.rate), (sizes.thermometer, parts.warmth),
    ):  # fmt: skip
        if shape.size and size > 0.0:
            found += size * shape[:, :, None] * rng.standard_normal((count, 1, draws))
    return found


def _root(kernel: np.ndarray) -> np.ndarray:
    """R with RRᵀ = K_c."""
    values, vectors = np.linalg.eigh(kernel)
    kept = values > SMALLEST * values[-1]
    return vectors[:, kept] * np.sqrt(values[kept])
