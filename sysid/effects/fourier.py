"""Operations on one whole cycle that are exact for its harmonics."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Complex, Float

from sysid.motion.motion import Motion, strides_of

Signal = Float[Array, "*batch n"]


def angular_frequencies(motion: Motion) -> Float[Array, "*batch h"]:
    """ω_k = 2π k f of the harmonics that a real transform of the cycle holds, rad/s."""
    n = motion.displacement.shape[-1]
    return 2.0 * jnp.pi * motion.frequency * jnp.arange(n // 2 + 1)


def transferred(
    signal: Signal, change: Complex[Array, "*batch h"] | Float[Array, "*batch h"]
) -> Signal:
    """Signal plus what a transfer function adds to it; zero change is exactly the identity.

    Args:
        signal: One cycle, [..., n].
        change: G(iω_k) − 1, [..., n // 2 + 1].
    """
    n = signal.shape[-1]
    return signal + jnp.fft.irfft(jnp.fft.rfft(signal, axis=-1) * change, n=n, axis=-1)


def refined(motion: Motion, times: int) -> Motion:
    """The same cycle on a grid `times` as fine; point j becomes point j·times.

    Displacement, velocity and acceleration by their harmonics, exactly band-limited; the sign of
    the acceleration stays what it is between two points, and anything else is interpolated.  A
    valve that moves in a share of the time about a point has its mean velocity.
    """
    if times == 1:
        return motion
    n = motion.displacement.shape[-1]

    def harmonics(z: Signal) -> Float[Array, "*batch fine"]:
        return times * jnp.fft.irfft(jnp.fft.rfft(z, axis=-1), n=n * times, axis=-1)

    def lines(z: Signal) -> Float[Array, "*batch fine"]:
        if z.shape[-1] == 1:
            return z
        share = jnp.arange(times) / times
        following = jnp.roll(z, -1, axis=-1)
        between = z[..., None] + (following - z)[..., None] * share
        return between.reshape(*z.shape[:-1], n * times)

    place, travel = harmonics(motion.displacement), motion.travel
    if travel is not None:
        lost = jnp.repeat((travel - strides_of(motion.displacement)) / times, times, axis=-1)
        travel = strides_of(place) + lost
    time = motion.time[..., :1] + jnp.arange(n * times) / (motion.frequency * n * times)
    return eqx.tree_at(
        lambda m: (
            m.displacement, m.velocity, m.acceleration, m.acceleration_sign, m.peak_velocity,
            m.current, m.temperature, m.time, m.travel, m.cycle, m.share,
        ),
        motion,
        (
            place, harmonics(motion.velocity),
            harmonics(motion.acceleration), jnp.sign(lines(motion.acceleration_sign)),
            lines(motion.peak_velocity), lines(motion.current), lines(motion.temperature), time,
            travel, None if motion.cycle is None else lines(motion.cycle), None,
        ),
        is_leaf=lambda z: z is None,
    )  # fmt: skip
