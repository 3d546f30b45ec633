"""What measured loops determine, in numbers and in words: parameters, directions, quantities."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float
from scipy.special import ndtri

from sysid.data.loops import Loops
from sysid.identification.result import Fit
from sysid.models.coordinates import AbstractCoordinates
from sysid.models.simulate import simulate
from sysid.motion.motion import Motion, sine_motion
from sysid.parameters import specs
from sysid.uncertainty.covariance import LEVEL, estimate_of, magnitude_of
from sysid.uncertainty.determined import undetermined
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.free_parameters import free_parameters
from sysid.uncertainty.profiles import Profile

POINTS: Final = 180
FLAT: Final = 1e-12
"""Eigenvalue of the scaled information below which rounding is all there is."""
LEVELS: Final = 1e-3
"""A, currents nearer to each other than this are one."""
SAME_PERCENT: Final = 0.25
"""Quantities known alike, to this part of it, are told together."""


@dataclass(frozen=True)
class Known:
    """A quantity of one current that people read off a loop.

    Attributes:
        current: A.
        force: N, at the largest speed of the cycle, mean of both directions.
        force_sd: N.
        height: N, half the height of the loop at standstill: its hysteresis.
        height_sd: N.
    """

    current: float
    force: float
    force_sd: float
    height: float
    height_sd: float


@dataclass(frozen=True)
class Identifiability:
    """What the data say, and what they do not.

    Attributes:
        symbols: [n] free parameters.
        spectrum: [n] standard deviations of independent relative changes, largest first: from the
            Fisher information JᵀΣ⁻¹J in the paper's symbols, each in units of its magnitude.
        directions: [n, n] these changes, a row each.
        open: What is left open, a sentence each.
        known: Quantities at each current.
        amplitude: m, of the cycle at which they are read.
        frequency: Hz.
        profiles: Of single parameters; empty if none were made.
    """

    symbols: tuple[str, ...]
    spectrum: Float[np.ndarray, " n"]
    directions: Float[np.ndarray, "n n"]
    open: tuple[str, ...]
    known: tuple[Known, ...]
    amplitude: float
    frequency: float
    profiles: tuple[Profile, ...] = ()

    @property
    def sentences(self) -> tuple[str, ...]:
        """Open directions, open intervals, and what is known for all that."""
        return (*self.open, *self.ends)

    @property
    def ends(self) -> tuple[str, ...]:
        """Open intervals, and what is known for all that."""
        return (*_of_profiles(self.profiles), *self._of_loops())

    def _of_loops(self) -> tuple[str, ...]:
        speed = 2.0 * np.pi * self.amplitude * self.frequency
        ends = float(ndtri(0.5 + LEVEL / 2))
        force = [(k.current, ends * k.force_sd / max(abs(k.force), 1e-300)) for k in self.known]
        height = [(k.current, ends * k.height_sd / max(abs(k.height), 1e-300)) for k in self.known]
        return (
            f"The force at {speed:.2g} m/s is known to {_alike(force)} (95 %)",
            f"The height of the loop at standstill is known to {_alike(height)} (95 %)",
        )


def identifiability(
    fit: Fit, errors: ErrorModel, profiles: Sequence[Profile] = ()
) -> Identifiability:
    """Say what a campaign determines of a model.

    Args:
        fit: The fit.
        errors: Its likelihood.
        profiles: Of its parameters, if there are any.
    """
    coordinates, u = fit.coordinates, jnp.asarray(errors.u)
    valve = coordinates.valve(u)
    declared = [s for s in specs(valve) if s.symbol in coordinates.free]
    theta, slopes = (np.asarray(z) for z in free_parameters(coordinates, u))
    magnitude = magnitude_of(theta, declared)
    covariance_u = _inverse(errors.information)
    relative = slopes @ covariance_u @ slopes.T / magnitude[:, None] / magnitude[None, :]
    variance, axes = np.linalg.eigh(relative)
    parameters = [
        estimate_of(s, float(v), float(np.sqrt(max(c, 0.0)) * m), float(ndtri(0.5 + LEVEL / 2)))
        for s, v, c, m in zip(declared, theta, np.diagonal(relative), magnitude, strict=True)
    ]
    amplitude, frequency, motion = _typical(errors.observed.loops)
    value, change = (np.asarray(z) for z in _read(coordinates, u, motion))
    sd = np.sqrt(np.maximum(np.einsum("rcn,nk,rck->rc", change, covariance_u, change), 0.0))
    return Identifiability(
        symbols=coordinates.free,
        spectrum=np.sqrt(np.maximum(variance[::-1], 0.0)),
        directions=axes.T[::-1],
        open=undetermined(coordinates.free, theta, relative, parameters),
        known=tuple(
            Known(float(i), *map(float, (value[0, k], sd[0, k], value[1, k], sd[1, k])))
            for k, i in enumerate(np.asarray(motion.current)[:, 0])
        ),
        amplitude=amplitude,
        frequency=frequency,
        profiles=tuple(profiles),
    )


def _inverse(information: Float[np.ndarray, "n n"]) -> Float[np.ndarray, "n n"]:
    """Covariance of u; directions that nothing depends on are given a factor of a million."""
    diagonal = np.diagonal(information)
    scale = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    curvature, axes = np.linalg.eigh(information / scale[:, None] / scale[None, :])
    curvature = np.maximum(curvature, FLAT * curvature[-1])
    return (axes / curvature) @ axes.T / scale[:, None] / scale[None, :]


def _typical(loops: Loops) -> tuple[float, float, Motion]:
    """Amplitude (m) and frequency (Hz) of median speed, and that cycle at every current."""
    middle = int(np.argsort(loops.peak_velocity)[len(loops.ids) // 2])
    amplitude, frequency = float(loops.amplitude[middle]), float(loops.frequency[middle])
    levels = np.unique(np.round(loops.current / LEVELS) * LEVELS) + 0.0
    warm = loops.temperature[np.isfinite(loops.temperature)]
    temperature = float(np.median(warm)) if warm.size else float("nan")
    return amplitude, frequency, sine_motion(amplitude, frequency, levels, temperature, POINTS)


@eqx.filter_jit
def _read(coordinates: AbstractCoordinates[Any], u: Array, motion: Motion) -> tuple[Array, Array]:
    """[2, current] N, force at the largest speed and half height at standstill; their slopes."""

    def at(z: Array) -> Array:
        force = simulate(coordinates.valve(z), motion)
        quarter = POINTS // 4
        fast, back = force[:, 0], force[:, 2 * quarter]
        turning, returning = force[:, quarter], force[:, 3 * quarter]
        return 0.5 * jnp.stack([fast - back, turning - returning])

    return at(u), jax.jacfwd(at)(u)


def _of_profiles(profiles: Sequence[Profile]) -> tuple[str, ...]:
    """Which intervals are open, and on which side."""
    told = []
    for p in profiles:
        below, above = p.closed
        unit = "" if p.declared.unit == "-" else f" {p.declared.unit}"
        if not (below or above):
            told.append(f"{p.symbol} may have any value: its profile is flat")
        elif not above:
            rest = _nothing_holds("above", p.declared.high)
            told.append(f"{p.symbol} is above {p.low:.3g}{unit}, and {rest}")
        elif not below:
            rest = _nothing_holds("below", p.declared.low)
            told.append(f"{p.symbol} is below {p.high:.3g}{unit}, and {rest}")
    return tuple(told)


def _nothing_holds(side: str, bound: float) -> str:
    if not np.isfinite(bound):
        return f"nothing bounds it from {side}"
    return f"{'up' if side == 'above' else 'down'} to its bound {bound:g} nothing holds it"


def _alike(known: Sequence[tuple[float, float]]) -> str:
    """Currents that are known alike, together: "±2 % at 0.2 A and 0.4 A; …"."""
    groups: list[tuple[float, list[float]]] = []
    for current, half in known:
        if groups and abs(half - groups[-1][0]) <= SAME_PERCENT * groups[-1][0]:
            groups[-1][1].append(current)
        else:
            groups.append((half, [current]))
    return "; ".join(f"{_percent(half)} at {_listed(at)}" for half, at in groups)


def _percent(half: float) -> str:
    return f"±{100.0 * half:.2g} %" if half < 1.0 else "no better than its own size"


def _listed(currents: Sequence[float]) -> str:
    if len(currents) > 2:
        return f"{currents[0]:.3g} to {currents[-1]:.3g} A"
    return " and ".join(f"{i:.3g}" for i in currents) + " A"
