"""Covariance of identified parameters that does not believe in independent residuals."""

from collections.abc import Sequence
from typing import Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float
from scipy.special import stdtrit

from sysid.identification.problem import SEGMENTS, Problem
from sysid.identification.result import Fit
from sysid.models.base import AbstractValve
from sysid.parameters import ParamSpec, build, specs, values
from sysid.uncertainty.determined import undetermined
from sysid.uncertainty.estimate import Estimate, Estimates

ENOUGH_CONDITIONS: Final = 8
LEVEL: Final = 0.95
SINGULAR: Final = 1e-11
"""Eigenvalue of the correlation-scaled H below which rounding is all there is."""
OPEN_FACTOR: Final = 1e4
"""Relative standard deviation that stands for "not at all determined"."""
OPEN: Final = 0.5
"""A parameter whose standard deviation exceeds this part of its magnitude is not identified."""


def sandwich(fit: Fit) -> Estimates:
    r"""95 % intervals from the scatter of whole conditions, not of points.

    The residuals of a loop, and of loops at one (amplitude, frequency), are not independent: what
    the model gets wrong at one point it gets wrong at the next.  So each cluster of loops is left
    out in turn (to first order) and the parameters' scatter is measured:

        δ_c = (H − H_c)⁻¹ s_c,  cov = (C − 1)/C Σ_c (δ_c − δ̄)(δ_c − δ̄)ᵀ

    with H = Σ JᵀJ, H_c and the score s_c = J_cᵀ r_c those of cluster c, of C.  Clusters are
    (amplitude, frequency) conditions where there are at least eight, single tests otherwise, and
    the tenths of a record that is not sinusoidal.
    Intervals use Student's t with C − 1 degrees of freedom and end at a parameter's own bounds.

    Args:
        fit: The fit.

    Source:
        Cluster-robust "CR3" covariance: Bell and McCaffrey, Survey Methodology 28 (2002).
    """
    declared = specs(fit.valve)
    free = fit.coordinates.free
    symbols = [spec.symbol for spec in declared]
    ties = tuple((symbols.index(a), symbols.index(b)) for a, b in fit.coordinates.ties)
    theta = np.asarray(values(fit.valve))
    index = np.array([k for k, spec in enumerate(declared) if spec.symbol in free])
    magnitude = magnitude_of(theta[index], [declared[k] for k in index])
    grams, cluster, clusters = _grams_and_clusters(fit, ties)
    scale = np.append(magnitude, 1.0)
    chosen = np.append(index, theta.size)
    grams = grams[:, chosen][:, :, chosen] * scale[:, None] * scale[None, :]
    points = int(sum(np.count_nonzero(p.weight) for p in fit.problems))
    relative, count = cluster_jackknife(grams, cluster, points)
    covariance = relative * magnitude[:, None] * magnitude[None, :]
    sd = np.sqrt(np.diagonal(covariance))
    quantile = float(stdtrit(max(count - 1, 1), 0.5 + LEVEL / 2))
    leader = dict(fit.coordinates.ties)
    deviation = dict(zip(free, sd.tolist(), strict=True))
    parameters = [
        estimate_of(
            spec, float(value), deviation.get(leader.get(spec.symbol, spec.symbol), 0.0), quantile
        )
        for spec, value in zip(declared, theta, strict=True)
    ]
    return Estimates(
        parameters=tuple(parameters),
        symbols=free,
        covariance=covariance,
        interval=f"{LEVEL:g}, sandwich over {clusters}",
        undetermined=undetermined(free, theta[index], relative, parameters),
    )


def cluster_jackknife(
    grams: Float[np.ndarray, "loop m m"], cluster: np.ndarray, points: int
) -> tuple[Float[np.ndarray, "n n"], int]:
    """Covariance by leaving clusters out to first order, never below that of independent noise.

    Few clusters see few directions; in those that they do not see (also in directions that no
    datum depends on) the scatter would be zero.  There the classical σ² H⁻¹ stands, which is
    infinite, here a factor of 10⁴, where H is singular to working precision.

    Args:
        grams: [L, n + 1, n + 1] matrices [J r]ᵀ[J r] of each test, J in relative changes.
        cluster: [L] number of each test's cluster.
        points: Number of residuals, N.

    Returns:
        Covariance [n, n] and the number of clusters.
    """
    names = np.unique(cluster)
    sums = np.stack([grams[cluster == c].sum(axis=0) for c in names])
    total = sums.sum(axis=0)
    H, n, count = total[:-1, :-1], total.shape[0] - 1, len(names)
    noise = total[-1, -1] / max(points - n, 1)
    half = _inverse_root(H, np.sqrt(noise))
    if count < 2:
        return half @ half.T, count
    ridge = 1e-12 * np.trace(H) * np.eye(n)
    shifts = np.stack([np.linalg.solve(H - g[:-1, :-1] + ridge, g[:-1, -1]) for g in sums])
    shifts -= shifts.mean(axis=0)
    scatter = (count - 1) / count * shifts.T @ shifts
    whiten = np.linalg.inv(half)
    inflation, vectors = np.linalg.eigh(whiten @ scatter @ whiten.T)
    root = half @ (vectors * np.sqrt(np.maximum(inflation, 1.0)))
    return root @ root.T, count


def _inverse_root(H: np.ndarray, noise: float) -> np.ndarray:
    """L with L Lᵀ = noise² H⁻¹; directions in which H is singular get a sd of OPEN_FACTOR."""
    scale = np.sqrt(np.maximum(np.diagonal(H), 1e-300))
    value, vector = np.linalg.eigh(H / scale[:, None] / scale[None, :])
    # along a singular direction v, changes are v / scale: make the largest one OPEN_FACTOR
    length = np.max(np.abs(vector / scale[:, None]), axis=0)
    sd = np.where(
        value > SINGULAR, noise / np.sqrt(np.maximum(value, SINGULAR)), OPEN_FACTOR / length
    )
    return vector / scale[:, None] * sd[None, :]


def _grams_and_clusters(
    fit: Fit, ties: tuple[tuple[int, int], ...]
) -> tuple[np.ndarray, np.ndarray, str]:
    """Gram matrices of all loops and record segments, each one's cluster, and what clusters are."""
    loops = len(fit.condition)
    conditions = int(fit.condition.max()) + 1 if loops else 0
    by_condition = conditions >= ENOUGH_CONDITIONS
    cluster = fit.condition if by_condition else np.arange(loops)
    clusters = ["conditions" if by_condition else "tests"] if loops else []
    grams = []
    for k, problem in enumerate(fit.problems):
        segments = 1 if k == 0 and loops else SEGMENTS
        if segments > 1:
            clusters.append(f"tenths of {problem.tests} records")
        grams.append(np.asarray(_test_grams(fit.valve, problem, ties, segments)))
    total = sum(len(g) for g in grams)
    first = int(cluster.max()) + 1 if loops else 0
    cluster = np.concatenate([cluster, first + np.arange(total - loops)])
    return np.concatenate(grams), cluster, " and ".join(clusters)


@eqx.filter_jit
def _test_grams(
    valve: AbstractValve,
    problem: Problem,
    ties: tuple[tuple[int, int], ...],
    segments: int,
) -> Float[Array, "part m m"]:
    """[J r]ᵀ[J r] of each segment of each test, J with respect to the declared parameters."""
    theta = values(valve)

    def one(test: Problem) -> Array:
        def residual(z: Array) -> Array:
            for follower, leader in ties:
                z = z.at[follower].set(z[leader])
            return jnp.asarray(test.weight * (build(valve, z).force(test.motion) - test.force))

        r, push = jax.linearize(residual, theta)
        full = jnp.concatenate([jax.vmap(push)(jnp.eye(theta.size)), r[None]])
        parts = full.reshape(theta.size + 1, segments, -1)
        return jnp.einsum("msk,nsk->smn", parts, parts)

    tests = jax.tree.map(lambda z: z if z.ndim > 1 else jnp.broadcast_to(z, problem.tests), problem)
    return jax.lax.map(one, tests).reshape(-1, theta.size + 1, theta.size + 1)


def magnitude_of(theta: np.ndarray, declared: Sequence[ParamSpec]) -> np.ndarray:
    """What a parameter's change is measured by: its own size, not below a tenth of the typical."""
    return np.maximum(np.abs(theta), [0.1 * spec.typical for spec in declared])


def estimate_of(spec: ParamSpec, value: float, sd: float, quantile: float) -> Estimate:
    """A parameter with its interval, which ends at the parameter's own bounds.

    Args:
        spec: Its declaration.
        value: In its unit.
        sd: Standard deviation, 0 where it is held fixed.
        quantile: Half width of the interval in standard deviations.
    """
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
