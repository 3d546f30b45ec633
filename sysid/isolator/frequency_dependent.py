r"""A damper whose force grows with frequency, whatever the motion.

The catalogue's law F (1 + ε log₁₀(f / 1 Hz)) speaks of a test's one frequency.  In a loop a motion
has none, so the law stands as a filter of the force,

    H(s) = h Π_j (s + z_j)/(s + p_j),    |H(iω)| ≈ (ω / 2π 1 Hz)^a,    10^a = 1 + ε

a fractional power of s over some decades: causal, and with the phase a · 90° that such a law must
have.

Source:
    A. Oustaloup et al., Frequency-band complex noninteger differentiator, IEEE Trans. Circuits
    Syst. I 47 (2000).
"""

from typing import Any, Final

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from sysid.isolator.damper_step import AbstractDamperStep
from sysid.isolator.implicit_stage import Port, onward
from sysid.isolator.plant import Number

BAND: Final = (0.05, 500.0)
"""Hz, in which the law holds."""
CELLS: Final = 4
"""Pole–zero pairs."""


class FrequencyDependent(AbstractDamperStep):
    """A damper and a filter of its force, ż_j = −p_j z_j + F, F_out = h (F + Σ r_j z_j).

    Attributes:
        inner: The damper.
        gain: h.
        residues: r_j, 1/s.
        poles: p_j, 1/s.
        tau: Of the inner one, s.
        largest_current: Of the inner one, A.
    """

    inner: AbstractDamperStep
    gain: Number
    residues: tuple[Number, ...]
    poles: tuple[Number, ...]
    tau: Number
    largest_current: float = eqx.field(static=True)

    def start(self) -> tuple[Any, tuple[Number, ...]]:
        """At rest."""
        return self.inner.start(), tuple(jnp.zeros_like(p) for p in self.poles)

    def stage(self, known: Any, meets: Port, current: Number) -> tuple[Any, Number]:
        """The inner damper meets what the filter leaves of the plant."""
        element, cells = known
        g = meets.length
        damped = [1.0 / (1.0 + g * p) for p in self.poles]
        kept = [d * z for d, z in zip(damped, cells, strict=True)]
        direct, past = 1.0 + 0.0 * self.gain, 0.0 * self.gain
        for r, d, z in zip(self.residues, damped, kept, strict=True):
            direct, past = direct + r * g * d, past + r * z
        direct, past = self.gain * direct, self.gain * past
        seen = Port(
            meets.velocity - meets.mobility * past, meets.mobility * direct,
            meets.displacement + meets.shift * past, meets.shift * direct, g,
        )  # fmt: skip
        element, force = self.inner.stage(element, seen, current)
        cells = tuple(k + g * d * force for k, d in zip(kept, damped, strict=True))
        return (element, cells), direct * force + past

    def carried(self, begin: Any, first: Any) -> Any:
        """As the inner damper has it, and the filter's states linearly."""
        cells = tuple(onward(y, z) for y, z in zip(begin[1], first[1], strict=True))
        return self.inner.carried(begin[0], first[0]), cells


def frequency_dependent(inner: AbstractDamperStep, per_decade: float) -> FrequencyDependent:
    """A damper whose force changes by ε per decade of frequency and is its own at 1 Hz.

    Args:
        inner: The damper.
        per_decade: ε.
    """
    power = np.log10(1.0 + per_decade)
    low, high = 2.0 * np.pi * np.asarray(BAND)
    ratio = (high / low) ** (1.0 / CELLS)
    middle = low * ratio ** (np.arange(CELLS) + 0.5)
    zeros, poles = middle * ratio ** (-0.5 * power), middle * ratio ** (0.5 * power)
    residues = [np.prod(zeros - p) / np.prod(np.delete(poles, j) - p) for j, p in enumerate(poles)]
    at_one = 2j * np.pi
    gain = 1.0 / abs(np.prod((at_one + zeros) / (at_one + poles)))
    return FrequencyDependent(
        inner=inner,
        gain=jnp.asarray(gain),
        residues=tuple(jnp.asarray(r) for r in residues),
        poles=tuple(jnp.asarray(p) for p in poles),
        tau=inner.tau,
        largest_current=inner.largest_current,
    )


def factor(per_decade: float, frequency: float) -> float:
    """|H| as the filter has it at a frequency, Hz, for tests and tables."""
    step = frequency_dependent(_Nothing(), per_decade)
    s = 2j * np.pi * frequency
    return abs(
        float(step.gain)
        * (
            1.0
            + sum(float(r) / (s + float(p)) for r, p in zip(step.residues, step.poles, strict=True))
        )
    )


class _Nothing(AbstractDamperStep):
    """A stand-in."""

    tau: Number = eqx.field(default_factory=lambda: jnp.ones(()))
    largest_current: float = eqx.field(static=True, default=1.0)

    def start(self) -> tuple[()]:
        """Nothing."""
        return ()

    def stage(self, known: Any, meets: Port, current: Number) -> tuple[Any, Number]:
        """Nothing."""
        return known, 0.0 * meets.velocity
