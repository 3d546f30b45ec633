"""The fit as a user writes it: NumPy residuals in the paper's symbols, for optimisers of others."""

from collections.abc import Callable
from typing import Final

import jax
import jax.numpy as jnp
import numpy as np
from campaigns import Campaign

from sysid.models.generalized import Generalized
from sysid.motion.motion import loop_motion
from sysid.parameters import build, specs

SYMBOLS: Final = tuple(spec.symbol for spec in specs(Generalized))
LOW: Final = np.array([spec.low for spec in specs(Generalized)])
TYPICAL: Final = np.array([spec.typical for spec in specs(Generalized)])
SCATTER: Final = 0.5


class Reached(Exception):  # noqa: N818  (not an error)
    """The best cost known has been reached."""


class PaperFit:
    """Residuals of one campaign divided by the RMS of its force, as fast as NumPy gives them.

    Everything that depends on the test alone is computed once a test, so that the only work per
    point is one tanh and a few products.  The sum of squares is Eq. 11 over Σ F².

    Attributes:
        target: Relative cost that counts as the optimum; None to run on.
        evaluations: Calls of `residuals`.
    """

    def __init__(self, campaign: Campaign) -> None:
        loops = campaign.loops
        sign = np.asarray(loop_motion(loops).acceleration_sign)
        self._v, self._abs_v, self._sign = loops.velocity, np.abs(loops.velocity), sign
        self._forward = loops.velocity >= 0.0
        self._v_m, self._i = loops.peak_velocity[:, None], loops.current[:, None]
        self._scale = 1.0 / np.sqrt(np.sum(loops.force**2))
        self._force = loops.force * self._scale
        self.truth = np.array([campaign.truth[s] for s in SYMBOLS])
        self.target: float | None = None
        self.evaluations = 0
        self.lowest = np.inf

    def residuals(self, theta: np.ndarray) -> np.ndarray:
        """(F̂ − F)/√ΣF², [tests · points]; raises `Reached` at the target.

        Overflow far from the optimum is cut to a large number: a user's fit would stop there.
        """
        F_0, I_0, I_1, a_0, a_1, a_2, a_3, a_4, k_0, k_1c, k_1e, k_2, k_3, k_4, k_5, k_6 = theta
        v_m, i = self._v_m, self._i
        with np.errstate(all="ignore"):
            gain = np.maximum(1.0, 1.0 + k_2 * (_logistic(a_2 * (i + I_0)) - _logistic(a_2 * I_0)))
            width = k_4 * v_m * (1.0 + k_3 * (_logistic(a_3 * (i + I_1)) - _logistic(a_3 * I_1)))
            F_t = F_0 * (1.0 + np.exp(a_1 * v_m))
            half = 0.5 * a_0 / (1.0 + k_0 * v_m)
            decay = np.exp(-a_4 * v_m)
            z = self._sign * (half * width)
            z += half * self._v
            z += half * k_6 * v_m
            np.tanh(z, out=z)
            z *= gain * F_t * self._scale
            z -= gain * k_5 * gain * F_t * self._scale
            z *= 1.0 + np.where(self._forward, k_1c * decay, k_1e * decay) * self._abs_v
            z -= self._force
        r = z.ravel()
        cost = float(r @ r)
        if not cost < 1e20:
            r, cost = np.clip(np.nan_to_num(r, nan=1e6), -1e6, 1e6), np.inf
        self.evaluations += 1
        self.lowest = min(self.lowest, cost)
        if self.target is not None and cost <= self.target:
            raise Reached
        return r

    def cost(self, theta: np.ndarray) -> float:
        """Σ (F̂ − F)² / Σ F²."""
        r = self.residuals(theta)
        return float(r @ r)

    def start(self, rng: np.random.Generator, *, gaussian: bool = False) -> np.ndarray:
        """The truth, every parameter multiplied by 1 ± 50 %; parameters that are zero stay zero.

        A draw that would give a positive parameter the wrong sign is reflected.

        Args:
            rng: Draws the factors.
            gaussian: Normal with standard deviation 50 % instead of even between ±50 %.
        """
        n = self.truth.size
        scatter = rng.normal(0.0, SCATTER, n) if gaussian else rng.uniform(-SCATTER, SCATTER, n)
        drawn = self.truth * (1.0 + scatter)
        return np.where(np.isfinite(LOW), np.abs(drawn), drawn)


def _logistic(z: np.ndarray) -> np.ndarray:
    return 1.0 / (1.0 + np.exp(-z))


def jacobian(campaign: Campaign) -> Callable[[np.ndarray], np.ndarray]:
    """∂residuals/∂θ by JAX, compiled, [tests · points, 16]: the peers' "our Jacobian"."""
    motion = loop_motion(campaign.loops)
    scale = 1.0 / float(np.sqrt(np.sum(campaign.loops.force**2)))
    identity = jnp.eye(len(SYMBOLS))

    def force(z: jax.Array) -> jax.Array:
        return scale * build(Generalized, z).force(motion).ravel()

    @jax.jit
    def columns(theta: jax.Array) -> jax.Array:
        push = jax.linearize(force, theta)[1]
        return jax.vmap(push, out_axes=1)(identity)

    return lambda theta: np.nan_to_num(np.asarray(columns(jnp.asarray(theta))))
