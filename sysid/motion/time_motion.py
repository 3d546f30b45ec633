"""A motion from its time history: any shape, any increasing time grid."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from sysid.errors import DataError
from sysid.motion.derivatives import causal_derivatives, smooth_derivatives
from sysid.motion.motion import Motion

Samples = Float[np.ndarray, " n"]

FEWEST_SAMPLES = 7
"""A quintic spline and its noise level need so many."""


def time_motion(
    time: Samples,
    displacement: Samples,
    *,
    velocity: Samples | None = None,
    acceleration: Samples | None = None,
    current: Samples | float,
    temperature: Samples | float | None = None,
    causal: bool = False,
) -> Motion:
    """The motion that a time history describes.

    Derivatives that are not given are those of the whole record (`smooth_derivatives`), or of past
    samples only (`causal_derivatives`).  A given velocity is used as it is, and the acceleration
    is then the velocity's derivative.

    v_m = √max(v² − ẍ x, 0) at every point (W11 Eq. 10).  The radicand is exact for a sinusoid
    about zero only; where it is negative it is clipped at 0.  Displacement must therefore be
    relative to the centre of the motion: 1 mm of offset costs tens of newtons.

    Args:
        time: [n] s, strictly increasing.
        displacement: [n] m, relative to the centre.
        velocity: [n] m/s.
        acceleration: [n] m/s².
        current: [n] A, or one value.
        temperature: [n] °C, or one value; NaN if not given.
        causal: Derivatives from past samples only.

    Returns:
        Arrays [n].

    Raises:
        DataError: Time does not increase, or there are fewer than `FEWEST_SAMPLES` samples.

    Source:
        W11 Eq. 10, radicand clipped as this project reads it.
    """
    _refuse(time)
    x = np.asarray(displacement, dtype=np.float64)
    v, a = velocity, acceleration
    if v is None or a is None:
        first, second = _derivatives(time, x, causal)
        if v is None:
            v, a = first, (second if a is None else a)
        elif a is None:
            a = _derivatives(time, v, causal)[0]
    assert a is not None
    t = np.nan if temperature is None else temperature
    return Motion(
        displacement=jnp.asarray(x),
        velocity=jnp.asarray(v),
        acceleration=jnp.asarray(a),
        acceleration_sign=jnp.asarray(np.sign(a)),
        peak_velocity=jnp.asarray(point_peak_velocity(x, v, a)),
        current=jnp.broadcast_to(jnp.asarray(current, dtype=jnp.float64), x.shape),
        temperature=jnp.broadcast_to(jnp.asarray(t, dtype=jnp.float64), x.shape),
        time=jnp.asarray(time),
        frequency=jnp.full(1, jnp.nan),
        periodic=False,
    )


def point_peak_velocity(x: Samples, v: Samples, a: Samples) -> Samples:
    """v_m = √max(v² − ẍ x, 0), m/s (W11 Eq. 10, radicand clipped at 0).

    Args:
        x: [n] m, relative to the centre.
        v: [n] m/s.
        a: [n] m/s².
    """
    return np.sqrt(np.maximum(v**2 - a * x, 0.0))


def clipped_share(motion: Motion) -> float:
    """Share of points at which the radicand of W11 Eq. 10 was negative and clipped."""
    radicand = motion.velocity**2 - motion.acceleration * motion.displacement
    scale = jnp.max(motion.velocity**2)
    return float(jnp.mean(radicand < -1e-9 * scale))


def _derivatives(time: Samples, values: Samples, causal: bool) -> tuple[Samples, Samples]:
    if causal:
        return causal_derivatives(time, values)
    return smooth_derivatives(time, values)[1:]


def _refuse(time: Samples) -> None:
    if time.size < FEWEST_SAMPLES:
        raise DataError(
            f"{time.size} samples are too few, at least {FEWEST_SAMPLES} are needed",
            advice="Give a longer motion, or sample it more finely",
        )
    backward = np.flatnonzero(np.diff(time) <= 0.0)
    if backward.size:
        row = int(backward[0]) + 1
        raise DataError(
            f"time does not increase from sample {row} ({time[row - 1]:g} s) to {row + 1} "
            f"({time[row]:g} s)",
            advice="Sort the rows by time and remove repeated ones",
        )
