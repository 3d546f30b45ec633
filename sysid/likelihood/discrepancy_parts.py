"""What the discrepancy covariance is made of: noise, force, rate, laws, and K_c over tests."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.linalg import eigh

from sysid.data.loops import Loops
from sysid.likelihood.compress import HarmonicBasis
from sysid.likelihood.kernel import LENGTHS, Lengths, kernel_of

ROLL_OFF: Final = 3.0
"""Harmonic at which the structural error has fallen to half."""
RIG: Final = ("gain", "offset", "delay", "thermometer")
"""Errors of the rig that are anew in every test."""
LAWS: Final = ("scale", "width", "steepness", "growth")
"""Laws of the valve whose relative errors are smooth over conditions, in the order of
`Parts.laws`."""
SMALLEST: Final = 1e-10
"""Eigenvalues of K_c below this part of its largest are rounding: R leaves them out."""
HEARD: Final = 0.01
"""χ² of an error of all of the force, as large as what the model leaves, in one eigenvector of K_c,
below which R leaves it out."""
COPIED: Final = 1e-10
"""Squared difference of two cycles, parts of their squares, below which one is a copy."""
SILENT: Final = 1e-9
"""Scatter of cycles, parts of the force, below which it is rounding: all are copies of one."""


@dataclass(frozen=True)
class Modes:
    """What of Σ does not depend on sizes, in the modes of the structural term.

    Attributes:
        values: [L] Λ.
        turn: [L, L] N^−½ U, from modes to loops; its transpose leads back.
        rolled: [2, m] K_p for unit sizes of odd and of even harmonics.
        varying: [t + P, L, m] what varies from test to test, of unit size: gain N, offset N, delay
            N/s and, where forces go by temperature, thermometer N/K; then the laws, N.
        smooth: [L, r], R with RRᵀ = K_c, for the laws; no columns where there are none.
        first: [G] the first coefficient of each harmonic.
        group: [m] the place of each coefficient's harmonic among them.
    """

    values: Float[np.ndarray, " loop"]
    turn: Float[np.ndarray, "loop loop"]
    rolled: Float[np.ndarray, "2 m"]
    varying: Float[np.ndarray, "kind loop m"]
    smooth: Float[np.ndarray, "loop rank"]
    first: Int[np.ndarray, " harmonic"]
    group: Int[np.ndarray, " m"]


@dataclass(frozen=True)
class Parts:
    """What Σ is made of, for L loops and m coefficients each.

    Attributes:
        noise: [L] N, standard deviation of each coefficient.
        force: [L, m] N, coefficients of the force: of a model that was fitted, not the measured
            one, or a gain error of 100 % would explain every measurement.
        rate: [L, m] N/s, of its time derivative.
        scale: [L] N, RMS force.
        order: [m] harmonic of each coefficient.
        kernel: [L, L], K_c.
        lengths: Of K_c.
        warmth: [L, m] N/K, change of the valve's force with the temperature of a test's oil; the
            empty [0, 0] if it does not go by that.
        laws: [4, L, m] N, change of the force for a relative change of each of `LAWS` by one; the
            empty [0, L, m] if laws are taken to be exact; zeros for a law that the valve lacks.
        error: What the model leaves when it is fitted by least squares, parts of the RMS force,
            without static forces that it leaves free; infinite if not known.

    Raises:
        ValueError: Laws of another number, or laws or warmth of other loops.
    """

    noise: Float[np.ndarray, " loop"]
    force: Float[np.ndarray, "loop m"]
    rate: Float[np.ndarray, "loop m"]
    scale: Float[np.ndarray, " loop"]
    order: np.ndarray
    kernel: Float[np.ndarray, "loop loop"]
    warmth: Float[np.ndarray, "warm_loop warm_m"] = field(default_factory=lambda: np.zeros((0, 0)))
    # axes of their own names: empty laws may come with other loops, and get these here
    laws: Float[np.ndarray, "law law_loop law_m"] = field(
        default_factory=lambda: np.zeros((0, 0, 0))
    )
    error: float = np.inf
    lengths: Lengths = LENGTHS

    def __post_init__(self) -> None:
        """Give the empty laws the shape of the force; refuse laws of other loops."""
        if self.laws.shape[0] == 0:
            object.__setattr__(self, "laws", np.zeros((0, *self.force.shape)))
        if self.warmth.size and self.warmth.shape != self.force.shape:
            raise ValueError(
                f"The change with temperature has the shape {self.warmth.shape}, for a force of "
                f"{self.force.shape}: expected the same, or none at all."
            )
        if self.laws.shape[0] not in (0, len(LAWS)) or self.laws.shape[1:] != self.force.shape:
            raise ValueError(
                f"Laws have the shape {self.laws.shape}, for a force of {self.force.shape}: "
                f"expected {(len(LAWS), *self.force.shape)}, or no laws at all."
            )

    @property
    def rig(self) -> tuple[str, ...]:
        """What of `RIG` varies from test to test here."""
        return RIG if self.warmth.size else RIG[:-1]

    @cached_property
    def absent(self) -> tuple[str, ...]:
        """What Σ does not have here: sizes that are zero."""
        laws = LAWS[len(self.laws) :]
        lacking = (name for name, d in zip(LAWS, self.laws, strict=False) if not d.any())
        return (*(set(RIG) - set(self.rig)), *laws, *lacking)

    def of(self, kept: Bool[np.ndarray, " loop"]) -> "Parts":
        """The same for some of the tests."""
        return replace(
            self,
            noise=self.noise[kept],
            force=self.force[kept],
            rate=self.rate[kept],
            scale=self.scale[kept],
            kernel=self.kernel[np.ix_(kept, kept)],
            warmth=self.warmth[kept] if self.warmth.size else self.warmth,
            laws=self.laws[:, kept],
        )

    @cached_property
    def modes(self) -> Modes:
        """Modes of the structural term; found once, whatever the sizes."""
        whitened = self.scale / self.noise
        values, vectors = eigh(self.kernel * whitened[:, None] * whitened[None, :])
        odd = self.order % 2 == 1
        _, first, group = np.unique(self.order, return_index=True, return_inverse=True)
        offset = np.zeros_like(self.force)
        offset[:, 0] = 1.0
        return Modes(
            values=np.maximum(values, 0.0),
            turn=vectors / self.noise[:, None],
            rolled=np.stack([odd, ~odd]) / (1.0 + (self.order / ROLL_OFF) ** 4),
            varying=np.concatenate([np.stack(self._of_rig(offset)), self.laws]),
            smooth=self._smooth(),
            first=first,
            group=group,
        )

    def _of_rig(self, offset: Float[np.ndarray, "loop m"]) -> list[Float[np.ndarray, "loop m"]]:
        """Changes of the force for unit sizes of `rig`."""
        always = [self.force, offset, self.rate]
        return [*always, self.warmth] if self.warmth.size else always

    def _smooth(self) -> Float[np.ndarray, "loop rank"]:
        """R with RRᵀ = K_c, as far as errors of the laws are heard above the noise; never empty."""
        if self.laws.shape[0] == 0:
            return np.zeros((self.noise.size, 0))
        values, vectors = eigh(self.kernel)
        loudness = np.sqrt(np.sum(self.force**2, axis=1)) / self.noise
        heard = values * np.sum((vectors * loudness[:, None]) ** 2, axis=0)  # of an error of one
        kept = (values > SMALLEST * values[-1]) & (heard > HEARD / np.square(self.error))
        kept[np.argmax(heard)] = True
        return vectors[:, kept] * np.sqrt(values[kept])

    def to_modes(self, a: Float[np.ndarray, "loop m k"]) -> Float[np.ndarray, "loop m k"]:
        """Uᵀ N^−½ a: unit variance for noise, uncorrelated for the structural term."""
        return (self.modes.turn.T @ a.reshape(a.shape[0], -1)).reshape(a.shape)


def covariance_parts(
    loops: Loops, basis: HarmonicBasis, simulated: Float[np.ndarray, "loop m"] | None = None
) -> Parts:
    """Read the parts of Σ off the loops.

    The noise of a coefficient is the RMS, over cycles and coefficients, of the cycles' own
    coefficients about their mean, over √C; with a single cycle the median of the other tests.
    A cycle that is a copy of another is no evidence of its own and is not counted: a test of
    copies alone has a single cycle.

    Args:
        loops: L tests.
        basis: Harmonics.
        simulated: [L, m] N, of a fitted model; the measured force if there is none yet.
    """
    noise = np.full(len(loops.ids), np.nan)
    for k, deviations in enumerate(loops.deviations):
        if len(deviations) < 2:
            continue
        c = _distinct(basis.compress(deviations))
        cycles = c.shape[0]
        if cycles > 1:
            noise[k] = np.sqrt(np.sum(c**2) / (cycles - 1) / cycles / basis.order.size)
    scale = np.sqrt(np.mean(loops.force**2, axis=1))
    noise[noise < SILENT * scale] = np.nan
    typical = np.nanmedian(noise / scale) if np.isfinite(noise).any() else 1e-3
    noise = np.where(np.isfinite(noise), noise, typical * scale)
    force = basis.compress(loops.force) if simulated is None else simulated
    return Parts(
        noise=np.maximum(noise, 1e-5 * scale),
        force=force,
        rate=rate_of(force, loops, basis),
        scale=scale,
        order=basis.order,
        kernel=kernel_of(loops),
    )


def originals(c: Float[np.ndarray, "cycle m"]) -> Int[np.ndarray, " cycle"]:
    """The first cycle that each is a copy of: its own number where it is none."""
    size = np.sum(c**2, axis=1)
    apart = size[:, None] + size[None, :] - 2.0 * c @ c.T
    return np.argmax(apart <= COPIED * (size[:, None] + size[None, :]) + 1e-300, axis=1)


def _distinct(c: Float[np.ndarray, "cycle m"]) -> Float[np.ndarray, "some m"]:
    """Cycles without copies of earlier ones, about their own mean; one if all are copies."""
    kept = c[originals(c) == np.arange(len(c))]
    return kept - kept.mean(axis=0) if len(kept) < len(c) else c


def rate_of(
    force: Float[np.ndarray, "loop m"], loops: Loops, basis: HarmonicBasis
) -> Float[np.ndarray, "loop m"]:
    """Time derivative of a force, N/s.

    Args:
        force: [L, m] N.
        loops: L tests.
        basis: Harmonics.
    """
    return 2.0 * np.pi * loops.frequency[:, None] * derivative(force, basis)


def derivative(c: Float[np.ndarray, "loop m"], basis: HarmonicBasis) -> Float[np.ndarray, "loop m"]:
    """Coefficients of dF/dφ: cos nφ → −n sin nφ, sin nφ → n cos nφ.

    Args:
        c: [L, m] N.
        basis: Harmonics.

    Returns:
        [L, m] N/rad.
    """
    out = np.zeros_like(c)
    n = basis.order[1::2]
    out[:, 1::2] = n * c[:, 2::2]
    out[:, 2::2] = -n * c[:, 1::2]
    return out
