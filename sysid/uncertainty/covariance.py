"""Covariance of identified parameters that does not believe in independent residuals."""

from typing import Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float
from scipy import stats

from sysid.identification.problem import Problem
from sysid.identification.result import Fit
from sysid.models.base import AbstractValve
from sysid.parameters import ParamSpec, build, specs, values
from sysid.uncertainty.determined import undetermined
from sysid.uncertainty.estimate import Estimate, Estimates

ENOUGH_CONDITIONS: Final = 8
LEVEL: Final = 0.95
OPEN: Final = 0.5
"""A parameter whose standard deviation exceeds this part of its magnitude is not identified."""


def sandwich(fit: Fit) -> Estimates:
    r"""95 % intervals from the scatter of whole conditions, not of points.

    The residuals of a loop, and of loops at one (amplitude, frequency), are not independent: what
    the model gets wrong at one point it gets wrong at the next.  So each cluster of loops is left
    out in turn (to first order) and the parameters' scatter is measured:

        δ_c = (H − H_c)⁻¹ s_c,  cov = (C − 1)/C Σ_c (δ_c − δ̄)(δ_c − δ̄)ᵀ

    with H = Σ JᵀJ, H_c and the score s_c = J_cᵀ r_c those of cluster c, of C.  Clusters are
    (amplitude, frequency) conditions where there are at least eight, single tests otherwise.
    Intervals use Student's t with C − 1 degrees of freedom and end at a parameter's own bounds.

    Args:
        fit: The fit.

    Source:
        Cluster-robust "CR3" covariance: Bell and McCaffrey, Survey Methodology 28 (2002).
    """
    kind = type(fit.valve)
    declared = specs(kind)
    free = fit.coordinates.free
    symbols = [spec.symbol for spec in declared]
    ties = tuple((symbols.index(a), symbols.index(b)) for a, b in fit.coordinates.ties)
    theta = np.asarray(values(fit.valve))
    index = np.array([k for k, spec in enumerate(declared) if spec.symbol in free])
    magnitude = _magnitude(theta[index], [declared[k] for k in index])
    grams = np.asarray(_test_grams(kind, fit.valve, fit.problem, ties))
    scale = np.append(magnitude, 1.0)
    chosen = np.append(index, theta.size)
    grams = grams[:, chosen][:, :, chosen] * scale[:, None] * scale[None, :]
    conditions = int(fit.condition.max()) + 1
    by_condition = conditions >= ENOUGH_CONDITIONS
    cluster = fit.condition if by_condition else np.arange(grams.shape[0])
    relative, count = cluster_jackknife(grams, cluster)
    covariance = relative * magnitude[:, None] * magnitude[None, :]
    sd = np.sqrt(np.diagonal(covariance))
    quantile = float(stats.t.ppf(0.5 + LEVEL / 2, max(count - 1, 1)))
    leader = dict(fit.coordinates.ties)
    deviation = dict(zip(free, sd.tolist(), strict=True))
    parameters = [
        _estimate(
            spec, float(value), deviation.get(leader.get(spec.symbol, spec.symbol), 0.0), quantile
        )
        for spec, value in zip(declared, theta, strict=True)
    ]
    return Estimates(
        parameters=tuple(parameters),
        symbols=free,
        covariance=covariance,
        interval=f"{LEVEL:g}, sandwich over {'conditions' if by_condition else 'tests'}",
        undetermined=undetermined(free, theta[index], relative, parameters),
    )


def cluster_jackknife(
    grams: Float[np.ndarray, "loop m m"], cluster: np.ndarray
) -> tuple[Float[np.ndarray, "n n"], int]:
    """Covariance by leaving clusters out to first order.

    Args:
        grams: [L, n + 1, n + 1] matrices [J r]ᵀ[J r] of each test.
        cluster: [L] number of each test's cluster.

    Returns:
        Covariance [n, n] and the number of clusters.
    """
    names = np.unique(cluster)
    sums = np.stack([grams[cluster == c].sum(axis=0) for c in names])
    H = sums.sum(axis=0)[:-1, :-1]
    ridge = 1e-12 * np.trace(H) * np.eye(H.shape[0])
    shifts = np.stack([np.linalg.solve(H - g[:-1, :-1] + ridge, g[:-1, -1]) for g in sums])
    count = len(names)
    if count < 2:
        residual = sums.sum(axis=0)[-1, -1]
        return np.linalg.inv(H + ridge) * residual, 1
    shifts -= shifts.mean(axis=0)
    return (count - 1) / count * shifts.T @ shifts, count


@eqx.filter_jit
def _test_grams(
    kind: type[AbstractValve],
    valve: AbstractValve,
    problem: Problem,
    ties: tuple[tuple[int, int], ...],
) -> Float[Array, "loop m m"]:
    """[J r]ᵀ[J r] of each test, J with respect to the declared parameters."""
    theta = values(valve)

    def one(test: Problem) -> Array:
        def residual(z: Array) -> Array:
            for follower, leader in ties:
                z = z.at[follower].set(z[leader])
            return test.weight * (build(kind, z).force(test.motion) - test.force)

        r, push = jax.linearize(residual, theta)
        full = jnp.concatenate([jax.vmap(push)(jnp.eye(theta.size)), r[None]])
        return full @ full.T

    tests = jax.tree.map(lambda z: z if z.ndim > 1 else jnp.broadcast_to(z, problem.tests), problem)
    return jax.lax.map(one, tests)


def _magnitude(theta: np.ndarray, declared: list[ParamSpec]) -> np.ndarray:
    """What a parameter's change is measured by: its own size, not below a tenth of the typical."""
    return np.maximum(np.abs(theta), [0.1 * spec.typical for spec in declared])


def _estimate(spec: ParamSpec, value: float, sd: float, quantile: float) -> Estimate:
    return Estimate(
        symbol=spec.symbol,
        name=spec.name,
        unit=spec.unit,
        value=value,
        sd=sd,
        low=max(spec.low, value - quantile * sd),
        high=min(spec.high, value + quantile * sd),
        identified=bool(sd <= OPEN * max(abs(value), 0.1 * spec.typical)),
    )
