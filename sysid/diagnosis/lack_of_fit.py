"""Lack of fit: how much larger than repeatability a residual is, where, and of what kind."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.special import fdtrc

from sysid.data.loops import Loops
from sysid.diagnosis.exponents import Exponent, exponents
from sysid.diagnosis.iso_velocity import Contrast, iso_velocity_contrasts
from sysid.diagnosis.parity import PARITIES, Parity, parity_shares, split_by_parity

NOISE_HARMONICS: Final = 15
"""Harmonics in which cycles and residual are compared: what a damper's loop is made of."""


@dataclass(frozen=True)
class LackOfFit:
    """What a model's residual shows before any cause is thought of.

    Attributes:
        residual: [L, J] N, measured minus simulated.
        f_ratio: [L] mean square of the residual over that of the cycle mean's noise, harmonics
            0 … 15; 1 where the model is right, NaN with a single cycle.
        probability: [L] of so large a ratio by chance (F distribution).
        parity: Share of the residual's energy in each parity.
        size: Parity → [L] N, RMS of that part of each test's residual.
        exponents: Parity → how that part grows with amplitude, frequency and current.
        contrasts: Pairs of equal peak velocity, largest ratio first.
    """

    residual: Float[np.ndarray, "loop phase"]
    f_ratio: Float[np.ndarray, " loop"]
    probability: Float[np.ndarray, " loop"]
    parity: dict[Parity, float]
    size: dict[Parity, Float[np.ndarray, " loop"]]
    exponents: dict[Parity, tuple[Exponent, ...]]
    contrasts: tuple[Contrast, ...]


def lack_of_fit(loops: Loops, simulated: Float[np.ndarray, "loop phase"]) -> LackOfFit:
    """Compare a simulation with the loops and with their own repeatability.

    Args:
        loops: L tests.
        simulated: [L, J] N, free run of the model on the same phase grid.
    """
    residual = loops.force - simulated
    ratio, probability = _f_test(loops, residual)
    parts = split_by_parity(residual)
    size: dict[Parity, np.ndarray] = {
        p: np.sqrt(np.mean(part**2, axis=1)) for p, part in parts.items()
    }
    return LackOfFit(
        residual=residual,
        f_ratio=ratio,
        probability=probability,
        parity=parity_shares(residual),
        size=size,
        exponents={p: exponents(loops, size[p]) for p in PARITIES},
        contrasts=iso_velocity_contrasts(loops),
    )


def _f_test(
    loops: Loops, residual: Float[np.ndarray, "loop phase"]
) -> tuple[Float[np.ndarray, " loop"], Float[np.ndarray, " loop"]]:
    """F ratio of each test's residual against its own cycle noise, and its probability.

    Noise is not white over phase, so both are taken in harmonics 0 … 15, whose 31 real amplitudes
    are nearly independent; C cycles give 31 (C − 1) degrees of freedom to the noise.
    """
    count = 2 * NOISE_HARMONICS + 1
    ratio, probability = np.full(len(loops.ids), np.nan), np.full(len(loops.ids), np.nan)
    for k, deviations in enumerate(loops.deviations):
        cycles = deviations.shape[0]
        if cycles < 2:
            continue
        noise = _low_power(deviations).sum() / (cycles - 1) / cycles
        if noise > 0.0:
            ratio[k] = _low_power(residual[k : k + 1]).sum() / noise
            probability[k] = fdtrc(count, count * (cycles - 1), ratio[k])
    return ratio, probability


def _low_power(signals: Float[np.ndarray, "signal phase"]) -> Float[np.ndarray, " signal"]:
    """Mean square of each signal in harmonics 0 … 15."""
    spectrum = np.fft.rfft(signals, axis=1)[:, : NOISE_HARMONICS + 1] / signals.shape[1]
    power = np.abs(spectrum) ** 2
    return power[:, 0] + 2.0 * power[:, 1:].sum(axis=1)
