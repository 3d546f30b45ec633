"""Delay and lags of a signal: by harmonics on a cycle, causal on any other grid."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Inexact

from sysid.effects.first_order import first_order
from sysid.effects.fourier import angular_frequencies, transferred
from sysid.motion.motion import Motion

Signal = Float[Array, "*batch n"]


def delayed(signal: Signal, motion: Motion, delay: Float[Array, ""]) -> Signal:
    """The signal as it was `delay` ago, s; before the first sample it has its first value.

    On a cycle G = e^{−iωτ}; elsewhere by straight lines between samples.
    """
    if motion.periodic:
        omega = angular_frequencies(motion)
        return transferred(signal, jnp.exp(-1j * omega * delay) - 1.0)
    read = jnp.vectorize(jnp.interp, signature="(n),(n),(n)->(n)")
    time = jnp.broadcast_to(motion.time, signal.shape)
    return read(time - delay, time, signal)


def lagged(signal: Signal, motion: Motion, constant: Float[Array, ""]) -> Signal:
    """The signal behind a first-order lag; before the first sample it has its first value.

    On a cycle G = 1 / (1 + iωτ).  Elsewhere exact for a signal that is straight between samples:
    with q = τ/h and α = e^{−1/q},

        y_n = α y_{n−1} + (1 − q (1 − α)) u_n + (q (1 − α) − α) u_{n−1}.
    """
    if motion.periodic:
        product = 1j * angular_frequencies(motion) * constant
        return transferred(signal, -product / (1.0 + product))
    return _behind_pole(signal, motion, constant)


def lagged_twice(signal: Signal, motion: Motion, constant: Float[Array, ""]) -> Signal:
    """The signal behind a Butterworth filter of two poles; before the first sample as `lagged`.

    On a cycle G = 1 / (1 + √2 iωτ − ω²τ²).  Elsewhere, by partial fractions, the real part of
    (1 − i) times the signal behind one pole with the complex constant (1 + i)τ/√2.
    """
    if motion.periodic:
        product = 1j * angular_frequencies(motion) * constant
        change = jnp.sqrt(2.0) * product + product**2
        return transferred(signal, -change / (1.0 + change))
    one = _behind_pole(signal, motion, (1.0 + 1j) / jnp.sqrt(2.0) * constant)
    return ((1.0 - 1j) * one).real


def _behind_pole(
    signal: Signal, motion: Motion, constant: Inexact[Array, ""]
) -> Inexact[Array, "*batch n"]:
    """Behind one pole at −1/τ, which may be complex, from rest at the first value."""
    step = jnp.diff(jnp.broadcast_to(motion.time, signal.shape), axis=-1)
    ratio = constant / step
    some = jnp.abs(ratio) > 0.0
    alpha = jnp.where(some, jnp.exp(-1.0 / jnp.where(some, ratio, 1.0)), 0.0)
    held = ratio * (1.0 - alpha)
    drive = (1.0 - held) * signal[..., 1:] + (held - alpha) * signal[..., :-1]
    first = jnp.zeros_like(signal[..., :1])
    return first_order(
        jnp.concatenate([first + 1.0, alpha], axis=-1),
        jnp.concatenate([signal[..., :1], drive], axis=-1),
        periodic=False,
    )
