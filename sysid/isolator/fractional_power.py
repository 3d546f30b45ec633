r"""A fractional power of s as a filter with a few states, for a law of frequency in a loop.

The catalogue's law F (1 + ε log₁₀(f / 1 Hz)) speaks of a test's one frequency.  In a loop a motion
has none, so the law stands as a filter of the force,

    H(s) = h Π_j (s + z_j)/(s + p_j),    |H(iω)| ≈ (ω / 2π 1 Hz)^a,    10^a = 1 + ε

a fractional power of s over some decades: causal, and with the phase a · 90° that such a law must
have.

Source:
    A. Oustaloup et al., Frequency-band complex noninteger differentiator, IEEE Trans. Circuits
    Syst. I 47 (2000).
"""

from typing import Final, NamedTuple

import equinox as eqx
import jax.numpy as jnp

from sysid.isolator.plant import Number

BAND: Final = (0.05, 500.0)
"""Hz, in which the law holds."""
CELLS: Final = 4
"""Pole–zero pairs."""


class Filtered(NamedTuple):
    """What a stage makes of a force, F_out = direct F + past, and of the cells.

    Attributes:
        direct: -.
        past: N.
        kept: Of each cell without the force.
        taken: Of each cell per newton.
    """

    direct: Number
    past: Number
    kept: tuple[Number, ...]
    taken: tuple[Number, ...]

    def after(self, force: Number) -> tuple[Number, ...]:
        """Cells at the end of the stage with a force, N."""
        return tuple(k + t * force for k, t in zip(self.kept, self.taken, strict=True))


class FractionalPower(eqx.Module):
    """ż_j = −p_j z_j + F,  F_out = h (F + Σ r_j z_j).

    Attributes:
        gain: h.
        residues: r_j, 1/s.
        poles: p_j, 1/s.
    """

    gain: Number
    residues: tuple[Number, ...]
    poles: tuple[Number, ...]

    def start(self) -> tuple[Number, ...]:
        """At rest."""
        return tuple(jnp.zeros_like(p) for p in self.poles)

    def met(self, known: tuple[Number, ...], length: Number) -> Filtered:
        """In a stage.

        Args:
            known: Cells, K.
            length: g, s.
        """
        damped = [1.0 / (1.0 + length * p) for p in self.poles]
        kept = tuple(d * z for d, z in zip(damped, known, strict=True))
        direct, past = 1.0 + 0.0 * self.gain, 0.0 * self.gain
        for r, d, z in zip(self.residues, damped, kept, strict=True):
            direct, past = direct + r * length * d, past + r * z
        taken = tuple(length * d for d in damped)
        return Filtered(self.gain * direct, self.gain * past, kept, taken)

    def factor(self, frequency: float) -> float:
        """|H| at a frequency, Hz."""
        s = 2j * jnp.pi * frequency
        cells = zip(self.residues, self.poles, strict=True)
        return abs(float(self.gain) * (1.0 + sum(float(r) / (s + float(p)) for r, p in cells)))


def fractional_power(per_decade: Number | float) -> FractionalPower:
    """The filter of a force that changes by ε per decade of frequency and is its own at 1 Hz.

    Args:
        per_decade: ε.
    """
    power = jnp.log10(1.0 + jnp.asarray(per_decade))
    low, high = (2.0 * jnp.pi * f for f in BAND)
    ratio = (high / low) ** (1.0 / CELLS)
    middle = low * ratio ** (jnp.arange(CELLS) + 0.5)
    zeros, poles = middle * ratio ** (-0.5 * power), middle * ratio ** (0.5 * power)
    residues = tuple(
        jnp.prod(zeros - poles[j]) / jnp.prod(jnp.delete(poles, j) - poles[j]) for j in range(CELLS)
    )
    at_one = 2j * jnp.pi
    gain = 1.0 / jnp.abs(jnp.prod((at_one + zeros) / (at_one + poles)))
    return FractionalPower(gain, residues, tuple(poles))
