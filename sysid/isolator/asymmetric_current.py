r"""Asymmetric damping from a symmetric damper: W11's ADFG algorithm.

    i_d = M_p i_c
    M_p = (1 + p)/2 + (2/π) [p 1(v > 0) + 1(v ≤ 0) − (1 + p)/2] |atan(ζ v / v_m)|

so the current falls to p i_c in compression and rises to i_c in rebound, but gets there for
ζ → ∞ only: with p = 0 and ζ = 2 it is 0.148 i_c and 0.852 i_c at ±v_m.
"""

from dataclasses import dataclass

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.errors import DataError
from sysid.models.base import AbstractModel
from sysid.models.simulate import simulate
from sysid.motion.motion import Motion, sine_motion


@dataclass(frozen=True)
class Asymmetry:
    """What is asked of the current.

    Attributes:
        compression: p, current in compression over that in rebound, 0 to 1.
        smoothing: ζ, above 0.

    Raises:
        DataError: A number is outside its range.

    Source:
        W11 Eqs. 1 and 2, whose "p(v_r>0)U(v_r≤0)" is read as p in compression and 1 in rebound.
    """

    compression: float = 0.0
    smoothing: float = 2.0

    def __post_init__(self) -> None:
        if not (0.0 <= self.compression <= 1.0 and 0.0 < self.smoothing < float("inf")):
            raise DataError(
                f"no asymmetry has p = {self.compression:g} and ζ = {self.smoothing:g}",
                advice="p is from 0 to 1, ζ above 0",
            )

    def multiplier(
        self, velocity: Float[Array, "*batch n"], peak_velocity: Float[Array, "*batch m"]
    ) -> Float[Array, "*batch n"]:
        """M_p; its mean value (1 + p)/2 at rest, also where v_m is zero.

        Args:
            velocity: m/s, positive in compression.
            peak_velocity: v_m, m/s.
        """
        p = self.compression
        middle = 0.5 * (1.0 + p)
        # the angle of a point, not of a ratio, so rest is no division by zero
        angle = jnp.arctan2(self.smoothing * jnp.abs(velocity), peak_velocity)
        end = jnp.where(velocity > 0.0, p, 1.0)
        return middle + 2.0 / jnp.pi * (end - middle) * angle

    def driven(self, motion: Motion) -> Motion:
        """The motion with its current, which is the commanded one, made asymmetric."""
        current = self.multiplier(motion.velocity, motion.peak_velocity) * motion.current
        return eqx.tree_at(lambda m: m.current, motion, current)


@dataclass(frozen=True)
class Ratios:
    """γ, rebound over compression, of steady sinusoids.

    Attributes:
        peak_velocity: v_m, [L] m/s.
        current: Commanded, [L] A.
        at_peak: |F(−v_m)| / F(v_m), [L].
        of_extremes: |min F| / max F, [L].
    """

    peak_velocity: np.ndarray
    current: np.ndarray
    at_peak: np.ndarray
    of_extremes: np.ndarray


def ratios_of(model: AbstractModel, motion: Motion) -> Ratios:
    """γ of a damper on steady cycles of sine waves about zero.

    Args:
        model: With the lag of its coil as an effect, if it has one.
        motion: [L, J], its current as the damper gets it.
    """
    force = np.asarray(simulate(model, motion))
    return ratios(
        force,
        np.asarray(motion.velocity),
        np.asarray(jnp.broadcast_to(motion.peak_velocity, (force.shape[0], 1)))[:, 0],
        np.asarray(jnp.max(motion.current, axis=-1)),
    )


def ratios(
    force: Float[np.ndarray, "loop n"],
    velocity: Float[np.ndarray, "loop n"],
    peak_velocity: Float[np.ndarray, " loop"],
    current: Float[np.ndarray, " loop"],
) -> Ratios:
    """γ of loops, measured or simulated.

    Args:
        force: N.
        velocity: m/s.
        peak_velocity: m/s.
        current: A.
    """
    row = np.arange(force.shape[0])
    up, down = (force[row, z(velocity, axis=1)] for z in (np.argmax, np.argmin))
    return Ratios(peak_velocity, current, -down / up, -force.min(axis=1) / force.max(axis=1))


def asymmetric_sines(
    asymmetry: Asymmetry, amplitude: float, frequencies: list[float], currents: list[float]
) -> Motion:
    """Sine waves with an asymmetric current, every frequency at every current.

    Args:
        asymmetry: Of the current.
        amplitude: m.
        frequencies: Hz.
        currents: Commanded, A.
    """
    f, i = (z.ravel() for z in np.meshgrid(frequencies, currents, indexing="ij"))
    return asymmetry.driven(sine_motion(amplitude, f, i))
