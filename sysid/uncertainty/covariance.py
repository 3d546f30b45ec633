"""Covariance of identified parameters that does not believe in independent residuals."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int
from scipy.special import stdtrit

from sysid.identification.problem import SEGMENTS, Problem, weighted
from sysid.identification.result import Fit
from sysid.models.base import AbstractValve
from sysid.parameters import ParamSpec, build, specs, values
from sysid.uncertainty.determined import undetermined
from sysid.uncertainty.directions import OPEN_FACTOR, directions_of, shares_of
from sysid.uncertainty.estimate import Estimate, Estimates

ENOUGH_CONDITIONS: Final = 8
LEVEL: Final = 0.95
OPEN: Final = 0.5
"""A parameter whose standard deviation exceeds this part of its magnitude is not identified."""
IDLE: Final = 1e-12
"""Part of the cost below which a change by `OPEN_FACTOR` of a parameter changes nothing."""
NORMAL: Final = float(stdtrit(np.inf, 0.5 + LEVEL / 2))
"""Half width of an interval in standard deviations, where that is known exactly."""


Clusters = Literal["conditions", "tests"]


@dataclass(frozen=True)
class Grams:
    """Gram matrices of all loops and record segments of a fit.

    Attributes:
        of_each: [part, n + 1, n + 1] `[J r]ᵀ[J r]`, J with respect to relative changes of the free
            parameters.
        points: [part] number of residuals.
    """

    of_each: Float[np.ndarray, "part m m"]
    points: Int[np.ndarray, " part"]


def sandwich(fit: Fit, over: Clusters = "conditions", grams: Grams | None = None) -> Estimates:
    r"""95 % intervals from the scatter of whole conditions, not of points.

    The residuals of a loop, and of loops at one (amplitude, frequency), are not independent: what
    the model gets wrong at one point it gets wrong at the next.  So each cluster of loops is left
    out in turn (to first order) and the parameters' scatter is measured:

        δ_c = (H − H_c)⁻¹ s_c,  cov = (C − 1)/C Σ_c (δ_c − δ̄)(δ_c − δ̄)ᵀ

    with H = Σ JᵀJ, H_c and the score s_c = J_cᵀ r_c those of cluster c, of C.  Clusters are
    (amplitude, frequency) conditions where there are at least eight, single tests otherwise or
    where that is asked, and the tenths of a record that is not sinusoidal.
    Intervals use Student's t with C − 1 degrees of freedom and end at a parameter's own bounds.
    A single cluster can be compared with nothing: then they are those of `independent`.

    Args:
        fit: The fit.
        over: What is left out.
        grams: As from `grams_of`, where they are known.

    Source:
        Cluster-robust "CR3" covariance: Bell and McCaffrey, Survey Methodology 28 (2002).
    """
    grams = grams_of(fit) if grams is None else grams
    cluster, clusters = _clusters(fit, over, len(grams.points))
    relative, count = cluster_jackknife(grams.of_each, cluster, grams.points)
    if count < 2:
        return independent(fit, grams, "independent points, for want of a second test")
    quantile = float(stdtrit(max(count - 1, 1), 0.5 + LEVEL / 2))
    return _estimates(fit, relative, quantile, f"{LEVEL:g}, sandwich over {clusters}")


def independent(
    fit: Fit, grams: Grams | None = None, words: str = "independent points"
) -> Estimates:
    """95 % intervals as if every point of every loop erred on its own: (JᵀWJ)⁻¹ σ².

    What least squares prints everywhere.  Points of a loop do not err on their own, so they are
    far too narrow; they are there to compare with.

    Args:
        fit: The fit.
        grams: As from `grams_of`, where they are known.
        words: What the intervals are called.
    """
    grams = grams_of(fit) if grams is None else grams
    whole, points = grams.of_each.sum(axis=0), int(grams.points.sum())
    count = points - len(whole) + 1
    half = _noise_root(whole[None], np.array([points]))
    quantile = float(stdtrit(max(count, 1), 0.5 + LEVEL / 2))
    return _estimates(fit, half @ half.T, quantile, f"{LEVEL:g}, {words}")


def _estimates(
    fit: Fit, relative: Float[np.ndarray, "n n"], quantile: float, interval: str
) -> Estimates:
    declared, free = specs(fit.valve), fit.coordinates.free
    theta = np.asarray(values(fit.valve))
    index, magnitude = _free_ones(fit)
    covariance = relative * magnitude[:, None] * magnitude[None, :]
    sd = np.sqrt(np.diagonal(covariance))
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
        interval=interval,
        undetermined=undetermined(free, theta[index], relative, parameters),
    )


def _free_ones(fit: Fit) -> tuple[np.ndarray, np.ndarray]:
    """Places of the free parameters among all, and what their changes are measured by."""
    declared = specs(fit.valve)
    index = np.array([k for k, spec in enumerate(declared) if spec.symbol in fit.coordinates.free])
    theta = np.asarray(values(fit.valve))
    return index, magnitude_of(theta[index], [declared[k] for k in index])


def cluster_jackknife(
    grams: Float[np.ndarray, "loop m m"],
    cluster: Int[np.ndarray, " loop"],
    points: Int[np.ndarray, " loop"],
) -> tuple[Float[np.ndarray, "n n"], int]:
    """Covariance by leaving clusters out to first order; independent noise where they see nothing.

    Few clusters see few directions; in those that they do not see (also in directions that no
    datum depends on) the scatter would be zero.  It is zero, too, along what one cluster alone sees
    (`directions.ALONE`): without it the data say nothing there, and its score, which no other
    answers, is what the solver of the fit has left over.  There the covariance of independent noise
    stands, H⁻¹ (Σ_l σ_l² H_l) H⁻¹, which is infinite, here a factor of 10⁴, where H is singular to
    working precision.  Each test has the noise that its own residuals show: a quiet test's numbers
    are not made uncertain by a loud one, nor a loud one's certain by a quiet one.

    Args:
        grams: [L, n + 1, n + 1] matrices [J r]ᵀ[J r] of each test, J in relative changes.
        cluster: [L] number of each test's cluster.
        points: [L] number of residuals of each test.

    Returns:
        Covariance [n, n] and the number of clusters.
    """
    real = points > 0  # a short record that was filled up has parts without a point
    grams, cluster, points = grams[real], cluster[real], points[real]
    names = np.unique(cluster)
    sums = np.stack([grams[cluster == c].sum(axis=0) for c in names])
    n, count = grams.shape[1] - 1, len(names)
    half = _noise_root(grams, points)
    if count < 2:
        return half @ half.T, count
    shares = shares_of(sums[:, :-1, :-1], sums[:, :-1, -1])
    shifts = np.stack([s.axes @ s.over_rest(s.score) for s in shares])
    shifts -= shifts.mean(axis=0)
    scatter = (count - 1) / count * shifts.T @ shifts
    whiten = np.linalg.inv(half)
    inflation, vectors = np.linalg.eigh(whiten @ scatter @ whiten.T)
    inflation = np.where(
        inflation < _least_seen(n, count - 1), np.maximum(inflation, 1.0), inflation
    )
    root = half @ (vectors * np.sqrt(inflation))
    return root @ root.T, count


def _least_seen(directions: int, freedom: int) -> float:
    """Inflation below which the clusters' scatter in a direction is less than chance allows.

    The eigenvalues of a covariance that is estimated from few clusters spread about the true ones:
    of n directions and d degrees of freedom, from (1 − √(n/d))² on.  To raise all that are below
    one would make every interval too wide.

    Source:
        Marchenko and Pastur, Math. USSR Sb. 1 (1967).
    """
    return (1.0 - np.sqrt(directions / freedom)) ** 2 if directions < freedom else 1.0


def _noise_root(grams: np.ndarray, points: np.ndarray) -> np.ndarray:
    """L with L Lᵀ the covariance of independent noise; singular directions have OPEN_FACTOR."""
    each, squares = grams[:, :-1, :-1], grams[:, -1, -1]
    # in the directions that are seen H is the identity, and the share of a test in it its own H_l
    root, unseen = directions_of(each.sum(axis=0))
    shares = root.T @ each @ root
    used = np.trace(shares, axis1=1, axis2=2)
    noise = squares / np.maximum(points - used, 1.0)
    meat, turn = np.linalg.eigh(np.einsum("l,lij->ij", noise, shares))
    least = 1e-12 * max(float(meat[-1]), 1e-300) if meat.size else 0.0
    known = (root @ turn) * np.sqrt(np.maximum(meat, least))
    return np.concatenate([known, unseen], axis=1)


def grams_of(fit: Fit) -> Grams:
    """Gram matrices of all loops, then of the tenths of each other record."""
    symbols = [spec.symbol for spec in specs(fit.valve)]
    ties = tuple((symbols.index(a), symbols.index(b)) for a, b in fit.coordinates.ties)
    grams, points = [], []
    statics = fit.coordinates.statics_free
    for k, problem in enumerate(fit.problems):
        segments = 1 if k == 0 and len(fit.condition) else SEGMENTS
        found = _test_grams(fit.valve, problem, ties, segments, statics_free=statics)
        grams.append(np.asarray(found))
        points.append(np.count_nonzero(np.asarray(problem.weight).reshape(len(found), -1), axis=1))
    index, magnitude = _free_ones(fit)
    scale, chosen = np.append(magnitude, 1.0), np.append(index, len(symbols))
    relative = np.concatenate(grams)[:, chosen][:, :, chosen] * scale[:, None] * scale[None, :]
    return Grams(without_idle(relative), np.concatenate(points))


def without_idle(grams: Float[np.ndarray, "part m m"]) -> Float[np.ndarray, "part m m"]:
    """The same, exactly zero for parameters on which to all intents nothing depends.

    What is left of an exponential that is as good as zero would be scaled up to a direction that
    is seen, with a standard deviation beyond any number.  Nor is anything known of a parameter that
    a fit that failed has left where the force's change with it is no number.

    Args:
        grams: [part, n + 1, n + 1] of parameters that are relative changes, and of the residual.
    """
    action = np.diagonal(grams, axis1=1, axis2=2).sum(axis=0)
    idle = action[:-1] * OPEN_FACTOR**2 < IDLE * action[-1]
    keep = np.append(~idle, True) & np.isfinite(action)
    return np.where(keep[:, None] & keep, grams, 0.0)


def _clusters(fit: Fit, over: Clusters, total: int) -> tuple[Int[np.ndarray, " part"], str]:
    """Cluster of each part, and what clusters are."""
    loops = len(fit.condition)
    conditions = int(fit.condition.max()) + 1 if loops else 0
    by_condition = over == "conditions" and conditions >= ENOUGH_CONDITIONS
    cluster = fit.condition if by_condition else np.arange(loops)
    words = ["conditions" if by_condition else "tests"] if loops else []
    words += [f"tenths of {p.tests} records" for p in fit.problems[1 if loops else 0 :]]
    first = int(cluster.max()) + 1 if loops else 0
    return np.concatenate([cluster, first + np.arange(total - loops)]), " and ".join(words)


@eqx.filter_jit
def _test_grams(
    valve: AbstractValve,
    problem: Problem,
    ties: tuple[tuple[int, int], ...],
    segments: int,
    *,
    statics_free: bool,
) -> Float[Array, "part m m"]:
    """[J r]ᵀ[J r] of each segment of each test, J with respect to the declared parameters."""
    theta = values(valve)

    def one(test: Problem) -> Array:
        def residual(z: Array) -> Array:
            for follower, leader in ties:
                z = z.at[follower].set(z[leader])
            excess = build(valve, z).force(test.motion) - test.force
            return weighted(excess, test.weight, statics_free=statics_free)

        def along(direction: Array) -> tuple[Array, Array]:
            """Residual and its change: quicker than `jax.linearize` where a state is integrated."""
            return jax.jvp(residual, (theta,), (direction,))

        r, changes = jax.vmap(along, out_axes=(None, 0))(jnp.eye(theta.size))
        full = jnp.concatenate([changes, r[None]])
        parts = full.reshape(theta.size + 1, segments, -1)
        return jnp.einsum("msk,nsk->smn", parts, parts)

    tests = jax.tree.map(lambda z: z if z.ndim > 1 else jnp.broadcast_to(z, problem.tests), problem)
    return jax.lax.map(one, tests).reshape(-1, theta.size + 1, theta.size + 1)


def magnitude_of(theta: np.ndarray, declared: Sequence[ParamSpec]) -> np.ndarray:
    """What a parameter's change is measured by: its own size, not below a tenth of the typical.

    Args:
        theta: [n] parameters.
        declared: Of the same n.

    Returns:
        [n].
    """
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


def near_enough(spec: ParamSpec, value: float, low: float, high: float) -> bool:
    """The ends of a parameter's interval are near enough for it to be identified.

    Args:
        spec: Its declaration.
        value: In its unit.
        low: End of the interval, in the same unit.
        high: The other end.
    """
    sd = (high - low) / (2.0 * NORMAL)
    return bool(sd <= OPEN * max(abs(value), 0.1 * spec.typical))
