"""First and second time derivative of a signal from its newest four samples, on any grid."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.motion.motion import Motion

Signal = Float[Array, "*batch n"]
Start = Float[Array, "*batch 1"]


class BackwardDifferences(eqx.Module):
    r"""Coefficients d_m, e_m of  ẏ_n = Σ_m d_m y_{n−m}  and  ÿ_n = Σ_m e_m y_{n−m}, m = 0 … 3.

    On a whole cycle in equal steps: the third-order formula (11, −18, 9, −2)/6h, and
    (2, −5, 4, −1)/h² for the second derivative, both periodic.  On any other grid: the
    second-order formula for unequal steps; the signal is at rest before the first sample.

    Attributes:
        first: [4, ..., n] 1/s.
        second: [4, ..., n] 1/s².

    Source:
        E. Hairer, G. Wanner, Solving Ordinary Differential Equations II (1996), III.1 and V.1.
    """

    first: Float[Array, "4 *batch n"]
    second: Float[Array, "4 *batch n"]

    def rate(self, signal: Signal) -> Signal:
        """First derivative."""
        return _applied(self.first, signal)

    def curvature(self, signal: Signal) -> Signal:
        """Second derivative."""
        return _applied(self.second, signal)


def differences_of(motion: Motion) -> BackwardDifferences:
    """The formulas for the grid of a motion."""
    if motion.periodic:
        shape = motion.displacement.shape
        rate = jnp.broadcast_to(motion.frequency * shape[-1], shape)
        first = jnp.stack([c * rate / 6.0 for c in (11.0, -18.0, 9.0, -2.0)])
        second = jnp.stack([c * rate**2 for c in (2.0, -5.0, 4.0, -1.0)])
        return BackwardDifferences(first, second)
    return _on_unequal_steps(jnp.broadcast_to(motion.time, motion.displacement.shape))


def _on_unequal_steps(time: Signal) -> BackwardDifferences:
    h = jnp.diff(time, axis=-1)
    new, old = h[..., 1:], h[..., :-1]
    ratio, both = new / old, new + old
    none = jnp.zeros_like(new)
    first = _with_start(
        [
            (1.0 + 2.0 * ratio) / (1.0 + ratio) / new,
            -(1.0 + ratio) / new,
            ratio**2 / (1.0 + ratio) / new,
            none,
        ],
        [1.0 / h[..., :1], -1.0 / h[..., :1]],
    )
    second = _with_start([2.0 / (new * both), -2.0 / (new * old), 2.0 / (old * both), none], [])
    return BackwardDifferences(first, second)


def _with_start(rows: list[Signal], second: list[Start]) -> Float[Array, "4 *batch full"]:
    """Put the first sample (nothing moves) and the second (one step back) in front."""
    none = jnp.zeros_like(rows[0][..., :1])
    second = second + [none] * (4 - len(second))
    return jnp.stack(
        [jnp.concatenate([none, s, row], axis=-1) for s, row in zip(second, rows, strict=True)]
    )


def _applied(coefficients: Float[Array, "4 *batch n"], signal: Signal) -> Signal:
    return sum(
        (coefficients[m] * jnp.roll(signal, m, axis=-1) for m in range(1, 4)),
        start=coefficients[0] * signal,
    )
