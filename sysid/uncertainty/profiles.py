r"""Profile likelihoods: how far a parameter can go if all others give way.

    p(c) = min over u with θ(u) = c of rᵀΣ⁻¹r,     rise(c) = p(c) − p(θ̂)

A 95 % interval is where the rise stays below 3.84 (χ²₁).  For a linear model that is ±1.96 standard
errors; where parameters run off together the profile turns flat, and its interval is open.  Σ is
estimated, so under the full likelihood each parameter's rise is taken over the square of how much
wider its linear interval is with all Σs that may be right (`spread`) than under this one.
"""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Final

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float
from scipy.interpolate import PchipInterpolator
from scipy.special import chdtri

from sysid.identification.levenberg_marquardt import gram
from sysid.identification.multistart import BLOCK, in_blocks
from sysid.identification.result import Fit
from sysid.parameters import ParamSpec, specs
from sysid.uncertainty.covariance import LEVEL, NORMAL, OPEN, near_enough
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.profile_paths import (
    AGAIN,
    TOLERANCE,
    Gram,
    Ground,
    Path,
    Way,
    follow,
    ground_near,
)
from sysid.uncertainty.spread import spread_under

SPACING: Final = 0.8
"""Between points, in √rise: the interval is read between them from a curve that is nearly
straight."""
WIDE_SPACING: Final = 1.1
"""The same where only the ends are asked for."""


@dataclass(frozen=True)
class Profile:
    """How the likelihood falls along one parameter.

    Attributes:
        declared: The parameter.
        best: Its most probable value.
        values: [p] rising, `best` among them.
        rise: [p] of rᵀΣ⁻¹r, or of another cost over a factor of the parameter's own; at least 0.
        others: [p, n] all free parameters along the path, in the order of `symbols`.
        symbols: Of the free parameters.
        low: Where the interval ends; the parameter's bound, or −∞, where the profile stays below.
        high: Where it ends above.
        closed: The profile rises enough below, and above.
        level: Of the interval.
    """

    declared: ParamSpec
    best: float
    values: Float[np.ndarray, " p"]
    rise: Float[np.ndarray, " p"]
    others: Float[np.ndarray, "p n"]
    symbols: tuple[str, ...]
    low: float
    high: float
    closed: tuple[bool, bool]
    level: float = LEVEL

    @property
    def symbol(self) -> str:
        """Of the parameter."""
        return self.declared.symbol

    @property
    def determined(self) -> bool:
        """The interval has two ends that the data set."""
        return all(self.closed)

    def ended(self, low: float, high: float) -> tuple[bool, bool]:
        """Whether the data, or the parameter's bounds, end another interval below, and above.

        Where the profile stays low down to a bound, an interval that begins above it ends there by
        something else: because it is straight, or by a prior.

        Args:
            low: Where it begins, in the parameter's unit.
            high: Where it ends, likewise.
        """
        below, above = self.closed
        return below or low <= self.declared.low, above or high >= self.declared.high

    @property
    def identified(self) -> bool:
        """It has, and they are no further apart than the card asks of an identified parameter."""
        return self.determined and near_enough(self.declared, self.best, self.low, self.high)

    @property
    def root(self) -> Float[np.ndarray, " p"]:
        """[p] signed √rise, a straight line where the model is linear in the parameter."""
        return np.sign(self.values - self.best) * np.sqrt(self.rise)


def profiles(
    fit: Fit,
    errors: ErrorModel,
    symbols: Sequence[str] | None = None,
    *,
    threads: int = 2,
    progress: Callable[[str], None] | None = None,
) -> tuple[Profile, ...]:
    """Profile parameters of a fit.

    Every path starts at the optimum and goes outwards, each point from the one before along the
    direction in which the others give way, so that two or three Gauss–Newton steps are enough.

    Args:
        fit: The fit, for its coordinates.
        errors: Its likelihood; Σ is held, but for how well its sizes and lengths are known.
        symbols: Which; all free ones if None.
        threads: Paths that are followed at once.
        progress: Called with a line now and then.
    """
    coordinates = fit.coordinates

    def under_errors(u: np.ndarray) -> np.ndarray:
        residual, jacobian = errors.observed.look(coordinates, u)
        both = np.concatenate([jacobian, residual[:, :, None]], axis=2)
        if not np.isfinite(both).all():
            return np.full((u.size + 1, u.size + 1), np.nan)
        return errors.power * errors.covariance.inner(both, both)

    wanted = [s for s in coordinates.free if symbols is None or s in symbols]
    doubt = _doubt(fit, errors)
    inflation = {s: doubt.get(s, 1.0) for s in wanted}
    u = np.asarray(errors.u)
    return _profiles(fit, under_errors, u, inflation, SPACING, threads, progress)


def _doubt(fit: Fit, errors: ErrorModel) -> dict[str, float]:
    """Symbol → square of how much wider its interval is by all Σs that may be right."""
    if errors.kind != "full" or errors.spread is None:
        return {}
    place, spread = spread_under(fit, errors)
    variance = np.diagonal(spread.covariance)
    near = (spread.plain > 0.0) & (variance <= OPEN**2)
    wider = np.square(spread.quantile / NORMAL)
    wider[near] *= variance[near] / spread.plain[near]
    return dict(zip((s.symbol for s in place.declared), wider.tolist(), strict=True))


def profiles_of_eq_11(
    fit: Fit,
    inflation: Mapping[str, float],
    *,
    threads: int = 2,
    progress: Callable[[str], None] | None = None,
) -> tuple[Profile, ...]:
    """Profile the cost that was fitted, each parameter's rise over a factor of its own.

    The sum of squares is no likelihood, but it bends as the parameters do: with the factor that
    makes its curvature that of a covariance which knows the errors, its profile is an interval
    that follows a curved valley.

    Args:
        fit: The fit.
        inflation: Symbol → factor, for the parameters that are wanted: variance of the parameter
            over its element of the inverse of JᵀJ, r relative to the RMS of the measured force.
        threads: Paths that are followed at once.
        progress: Called with a line now and then.

    Source:
        Pace, Salvan and Sartori, Statistica Sinica 21 (2011): adjusted composite likelihood ratio
        for one parameter.
    """
    blocks = tuple(in_blocks(problem, BLOCK) for problem in fit.problems)
    unit = float(np.median(list(inflation.values())))

    def sums(u: np.ndarray) -> np.ndarray:
        # J and r of the model minus the measured force; here r is the other way round
        found = np.array(gram(fit.coordinates, blocks, jnp.asarray(u))) / unit
        found[:-1, -1] *= -1.0
        found[-1, :-1] *= -1.0
        return found

    shares = {s: z / unit for s, z in inflation.items()}
    return _profiles(fit, sums, np.asarray(fit.u), shares, WIDE_SPACING, threads, progress)


def _profiles(
    fit: Fit,
    gram_at: Gram,
    u: Float[np.ndarray, " n"],
    inflation: Mapping[str, float],
    spacing: float,
    threads: int,
    progress: Callable[[str], None] | None,
) -> tuple[Profile, ...]:
    free = fit.coordinates.free
    declared = {s.symbol: s for s in specs(fit.valve)}
    ground = ground_near(fit.coordinates, gram_at, u)
    paths: dict[str, list[Path]] = {}
    say = progress or (lambda line: None)
    with ThreadPoolExecutor(threads) as pool:
        for turn in range(AGAIN):
            ways = {
                s: [Way(ground, free.index(s), declared[s], z, factor, spacing) for z in (-1, 1)]
                for s, factor in inflation.items()
            }
            jobs = {s: [pool.submit(follow, way) for way in both] for s, both in ways.items()}
            paths = {s: [job.result() for job in both] for s, both in jobs.items()}
            lowest = min((p for both in paths.values() for side in both for p in side.points),
                         key=lambda p: p.cost, default=ground.best)  # fmt: skip
            if lowest.cost > ground.best.cost - 2.0 * TOLERANCE:
                break
            if turn == AGAIN - 1:  # paths belong to the place that they start from
                say("profiles found a better place once more: they are told from the one before")
                break
            say("profiles found a better place: they start again from there")
            ground = ground_near(fit.coordinates, gram_at, lowest.u)
    return tuple(
        _joined(ground, free, declared[s], both, inflation[s]) for s, both in paths.items()
    )


def _joined(
    ground: Ground,
    free: Sequence[str],
    declared: ParamSpec,
    sides: Sequence[Path],
    inflation: float,
) -> Profile:
    k = list(free).index(declared.symbol)
    below, above = sides
    points = [*below.points[::-1], ground.best, *above.points]
    at = np.array([float(p.theta[k]) for p in points])
    order = np.argsort(at, kind="stable")
    at = at[order]
    points = [points[i] for i in order]
    apart = np.append(True, np.diff(at) > 1e-12 * max(float(np.abs(at).max()), 1e-300))
    at, points = at[apart], [p for p, new in zip(points, apart, strict=True) if new]
    more = np.array([p.cost for p in points]) - ground.best.cost
    rise = np.maximum(more, 0.0) / inflation
    best = float(ground.best.theta[k])
    end = float(np.sqrt(chdtri(1, 1.0 - LEVEL)))
    return Profile(
        declared=declared,
        best=best,
        values=at,
        rise=rise,
        others=np.array([p.theta for p in points]),
        symbols=tuple(free),
        low=_crossing(at, rise, best, -end) if below.closed else declared.low,
        high=_crossing(at, rise, best, end) if above.closed else declared.high,
        closed=(below.closed, above.closed),
    )


def _crossing(
    at: Float[np.ndarray, " p"], rise: Float[np.ndarray, " p"], best: float, end: float
) -> float:
    """Where the signed √rise passes an end of the interval."""
    side = at <= best if end < 0.0 else at >= best
    x, y = at[side], np.sqrt(rise[side])
    if end < 0.0:
        x, y = x[::-1], y[::-1]
    # outwards, as far as it rises: a dip further out does not close the interval again
    y = np.maximum.accumulate(y)
    kept = np.append(True, np.diff(y) > 0.0)
    return float(PchipInterpolator(y[kept], x[kept])(abs(end)))
