"""Σ written out straight from its definition, draws from it, and REML held against it."""

from dataclasses import replace

import numpy as np
import pytest
from jaxtyping import Float

from sysid.likelihood.discrepancy import LAWS, NAMES, Covariance, Parts, Sizes
from sysid.likelihood.reml import full_rank, restricted_slopes

STEP = 1e-4
"""Of differences in ln size."""


def dense(parts: Parts, sizes: Sizes) -> np.ndarray:
    """[L·m, L·m] N²; for each law a matrix whose block (l, k) is s² d_l d_kᵀ K_c(l, k)."""
    loops, m = parts.force.shape
    sigma = np.zeros((loops, m, loops, m))
    for k in range(loops):
        block = parts.noise[k] ** 2 * np.eye(m)
        block += sizes.gain**2 * np.outer(parts.force[k], parts.force[k])
        block += sizes.delay**2 * np.outer(parts.rate[k], parts.rate[k])
        block[0, 0] += sizes.offset**2
        if parts.warmth.size:
            block += sizes.thermometer**2 * np.outer(parts.warmth[k], parts.warmth[k])
        sigma[k, :, k, :] = block
    K_c = parts.kernel * np.outer(parts.scale, parts.scale)
    size = np.where(parts.order % 2, sizes.odd, sizes.even) ** 2
    K_p = np.diag(size / (1.0 + (parts.order / 3.0) ** 4))
    sigma += np.einsum("ab,mn->ambn", K_c, K_p)
    for law, d in zip(LAWS, parts.laws, strict=False):
        sigma += getattr(sizes, law) ** 2 * np.einsum("lm,kn,lk->lmkn", d, d, parts.kernel)
    return sigma.reshape(loops * m, loops * m)


def draw(parts: Parts, sizes: Sizes, seed: int) -> np.ndarray:
    """[L, m] N, a residual that has Σ."""
    root = np.linalg.cholesky(dense(parts, sizes))
    z = np.random.default_rng(seed).standard_normal(root.shape[0])
    return (root @ z).reshape(parts.force.shape)


def restricted_likelihood(
    covariance: Covariance,
    residual: Float[np.ndarray, "loop m"],
    jacobian: Float[np.ndarray, "loop m n"],
) -> float:
    """−½ (log|Σ| + log|JᵀΣ⁻¹J| + rᵀPr), P = Σ⁻¹ − Σ⁻¹J(JᵀΣ⁻¹J)⁻¹JᵀΣ⁻¹.

    Args:
        covariance: Σ.
        residual: [L, m] N.
        jacobian: [L, m, n] of the base model's free parameters, columns of full rank.

    Source:
        Patterson and Thompson, Biometrika 58 (1971).
    """
    both = np.concatenate([jacobian, residual[:, :, None]], axis=2)
    gram = covariance.inner(both, both)
    sign, log_information = np.linalg.slogdet(gram[:-1, :-1])
    if sign <= 0.0:
        return -np.inf
    g = gram[:-1, -1]
    left = gram[-1, -1] - g @ np.linalg.solve(gram[:-1, :-1], g)
    return float(-0.5 * (covariance.log_determinant + log_information + left))


def jacobian_of(parts: Parts) -> np.ndarray:
    """[L, m, 2], of a model with two parameters."""
    return np.stack([parts.force, parts.rate * 0.01], axis=2)


def moved(sizes: Sizes, name: str, step: float) -> Sizes:
    """One size changed by a step of its logarithm."""
    return replace(sizes, **{name: getattr(sizes, name) * np.exp(step)})


def slopes_are_differences(parts: Parts, true: Sizes, at: Sizes) -> None:
    """REML and its slopes at some sizes against the likelihood itself, on a draw of others."""
    residual, solid = draw(parts, true, 5), full_rank(jacobian_of(parts))
    modal = parts.to_modes(np.concatenate([solid, residual[:, :, None]], axis=2))
    value, slopes, _ = restricted_slopes(Covariance(parts, at), modal)

    def likelihood(sizes: Sizes) -> float:
        return restricted_likelihood(Covariance(parts, sizes), residual, solid)

    assert value == pytest.approx(likelihood(at), rel=1e-9)
    for slope, name in zip(slopes, NAMES, strict=True):
        up, down = (likelihood(moved(at, name, sign * STEP)) for sign in (1, -1))
        assert slope == pytest.approx((up - down) / (2 * STEP), rel=1e-4, abs=1e-3), name


def average_information_is_that_of_the_matrix(parts: Parts, sizes: Sizes) -> None:
    """½ rᵀPΣ_iPΣ_jPr with P and ∂Σ/∂ln size written out."""
    residual, solid = draw(parts, sizes, 6), full_rank(jacobian_of(parts))
    modal = parts.to_modes(np.concatenate([solid, residual[:, :, None]], axis=2))
    average = restricted_slopes(Covariance(parts, sizes), modal)[2]
    inverse = np.linalg.inv(dense(parts, sizes))
    flat = solid.reshape(inverse.shape[0], -1)
    onto = inverse @ flat
    projection = inverse - onto @ np.linalg.solve(flat.T @ onto, onto.T)
    remains = projection @ residual.ravel()
    change = [
        (dense(parts, moved(sizes, n, STEP)) - dense(parts, moved(sizes, n, -STEP))) / (2 * STEP)
        for n in NAMES
    ]
    q = np.stack([one @ remains for one in change], axis=1)
    np.testing.assert_allclose(average, 0.5 * q.T @ projection @ q, rtol=1e-5, atol=1e-5)
