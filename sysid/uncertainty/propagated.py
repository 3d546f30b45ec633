r"""Intervals of fitted parameters from the errors that a campaign shows.

An estimator moves by δ = B Σ_l G_lᵀ e_l when the loops err by e, so with the covariance Σ of such
errors, found by REML,

    cov = B (Gᵀ Σ G) B

| estimator | G | B |
|---|---|---|
| least squares, Eq. 11 | w² J | (JᵀW J)⁻¹ |
| generalised least squares | Σ⁻¹ J | (JᵀΣ⁻¹J)⁻¹ |

Σ is known no better than its sizes s_i: of the variance V of a parameter V_i comes from each, the
standard deviation of ln s_i is known, Var(V) = 4 Σ_i V_i² sd_i², and V has 2V²/Var(V) degrees of
freedom for Student's t.  Sizes of smooth errors are known less well than REML says, which takes the
shape of their covariance over conditions for granted and their finest detail for evidence.  How
smooth errors of the laws are is not known either: V is averaged over what may be right
(`likelihood.plausible`), and the interval is that of the mixture of their t distributions.

The covariance belongs to the place that it is taken at, and a fit that happens to lie where an
estimator looks good believes itself: in Eq. 7 ln k_3 is known the better the smaller it was found.
So an estimator must also identify a parameter at the values that are most probable under Σ, which
come closer to the truth, as a parametric bootstrap would ask it to.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops
from sysid.identification.families import family
from sysid.identification.problem import test_weights
from sysid.identification.result import Fit
from sysid.likelihood.carried import carried
from sysid.likelihood.discrepancy import NAMES, RIG, Sizes
from sysid.likelihood.discrepancy_parts import Parts
from sysid.likelihood.plausible import Plausible
from sysid.models.base import AbstractValve
from sysid.models.coordinates import valve_at
from sysid.models.damper import Damper
from sysid.parameters import ParamSpec, specs, values
from sysid.uncertainty.covariance import (
    LEVEL,
    NORMAL,
    OPEN,
    estimate_of,
    magnitude_of,
    near_enough,
)
from sysid.uncertainty.declared import Declared
from sysid.uncertainty.determined import undetermined
from sysid.uncertainty.directions import directions_of
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.estimate import Estimate, Estimates
from sysid.uncertainty.mixture import half_width
from sysid.uncertainty.profiles import Profile, profiles_of_eq_11
from sysid.uncertainty.sample import observed_of

ALL: Final = 10_000
"""Harmonics: as many as the points carry, for Eq. 11 has them all."""
OF_SHAPE: Final = 0.2
"""Standard deviation of ln size of smooth errors beside what REML says: what another shape of K_c
than Σ's makes of them (`benchmarks/law_sizes.py`)."""
LEAST_FREEDOM: Final = 3.0
"""Degrees of freedom: of fewer, the formula for them knows nothing."""


@dataclass(frozen=True)
class Spread:
    """How far an estimator is from the truth, in relative changes of the parameters.

    Attributes:
        covariance: [n, n].
        plain: [n] diagonal of B alone.
        quantile: [n] half width of a 95 % interval in standard deviations.
    """

    covariance: Float[np.ndarray, "n n"]
    plain: Float[np.ndarray, " n"]
    quantile: Float[np.ndarray, " n"]


@dataclass(frozen=True)
class _Place:
    """A model, and its free parameters."""

    valve: AbstractValve
    declared: tuple[ParamSpec, ...]
    relative: Declared
    theta: Float[np.ndarray, " n"]
    magnitude: Float[np.ndarray, " n"]

    def sd(self, spread: Spread) -> Float[np.ndarray, " n"]:
        """Standard deviations in the parameters' units."""
        return self.magnitude * np.sqrt(np.diagonal(spread.covariance))


def by_eq_11(fit: Fit, loops: Loops, errors: ErrorModel, *, bent: bool = True) -> Estimates:
    """Intervals of the fitted values under the errors that the campaign shows.

    Where the model has no memory, ends are those of the profile of Eq. 11's own cost, scaled to
    the same standard deviation: a parameter whose profile stays low on a side is not identified,
    whatever its standard deviation at the optimum, and neither is one whose standard deviation is
    too large for its value at the most probable parameters under Σ.

    Args:
        fit: The fit.
        loops: Those that were fitted.
        errors: Σ at the fit (`errors_at`).
        bent: Follow profiles; to first order otherwise.
    """
    place = _place(fit, np.asarray(fit.u))
    spread = _spread_of_eq_11(fit, loops, errors, place)
    probable = _place(fit, errors.u)
    sd_there = probable.sd(_spread_of_eq_11(fit, loops, errors, probable))
    words = f"{LEVEL:g}, Eq. 11 under errors of rig and laws (Σ by REML)"
    if not (bent and family(fit.model).memoryless):
        return _held_against(_estimates(fit, place, spread, words), fit, place, sd_there)
    points = loops.force.shape[1]
    weight = test_weights(loops, fit.weights)[:, None]
    total = float(np.sum((weight * loops.force) ** 2))
    sd = place.sd(spread)
    plain = np.where(spread.plain > 0.0, spread.plain, np.inf)  # zero: acts on nothing
    wider = (spread.quantile / NORMAL) ** 2 * np.diagonal(spread.covariance) / plain
    inflation = {
        s.symbol: float(w * points / total)
        for s, w, near in zip(place.declared, wider, sd <= OPEN * place.magnitude, strict=True)
        if near
    }
    found = {p.symbol: p for p in profiles_of_eq_11(fit, inflation)} if inflation else {}
    estimates = _estimates(fit, place, spread, f"{words}, along profiles", found)
    lost = {p.symbol for p in estimates.parameters if not p.identified}
    more = tuple(_one_end(p) for p in found.values() if not p.determined and p.symbol in lost)
    estimates = replace(estimates, undetermined=(*estimates.undetermined, *more))
    return _held_against(estimates, fit, place, sd_there)


def _spread_of_eq_11(fit: Fit, loops: Loops, errors: ErrorModel, place: _Place) -> Spread:
    """Of least squares, if the parameters are those of the place."""
    jacobian, parts = _in_all_harmonics(fit, loops, errors, place)
    weight = test_weights(loops, fit.weights)[:, None, None]
    weighted = weight * jacobian
    H = np.einsum("lmi,lmj->ij", weighted, weighted)
    return mean_spread(H, weight * weighted, parts, errors.believed())


def _held_against(
    estimates: Estimates, fit: Fit, place: _Place, sd_there: Float[np.ndarray, " n"]
) -> Estimates:
    """Not identified, and said so, where the standard deviations of another place are too large.

    Args:
        estimates: With what is identified at the fit.
        fit: The fit.
        place: Where it is.
        sd_there: [n] standard deviations, in the parameters' units, at the most probable
            parameters under Σ.
    """
    leader = dict(fit.coordinates.ties)
    doubted = {
        s.symbol: sd
        for s, sd, size in zip(place.declared, sd_there.tolist(), place.magnitude, strict=True)
        if sd > OPEN * size
    }
    parameters, words = [], []
    for p in estimates.parameters:
        sd = doubted.get(leader.get(p.symbol, p.symbol))
        if sd is not None and p.identified:
            p, unit = replace(p, identified=False), "" if p.unit == "-" else f" {p.unit}"
            words.append(
                f"{p.symbol} looks determined at its fitted value (±{p.sd:.2g}{unit}), but not at "
                f"the one most probable under the errors of rig and laws (±{sd:.2g}{unit})"
            )
        parameters.append(p)
    return replace(
        estimates,
        parameters=tuple(parameters),
        undetermined=(*estimates.undetermined, *words),
    )


def _in_all_harmonics(
    fit: Fit, loops: Loops, errors: ErrorModel, place: _Place
) -> tuple[Float[np.ndarray, "loop m n"], Parts]:
    """Jacobian of the fitted model, and what Σ is made of, in as many harmonics as Eq. 11 has.

    Of a model with memory, which is computed at fewer points, in those that Σ was sought in.
    """
    observed = errors.observed
    if family(fit.model).memoryless:
        observed = observed_of(fit, loops, ALL)
    residual, jacobian = observed.look(place.relative, np.zeros(place.relative.size))
    parts = errors.observed.parts
    if observed is not errors.observed:
        parts = replace(
            observed.beside(Damper(place.valve), residual, apart=True).parts,
            noise=parts.noise, kernel=parts.kernel, lengths=parts.lengths,
        )  # fmt: skip
    if place.relative.statics_free:
        jacobian = np.concatenate([np.zeros_like(jacobian[:, :1]), jacobian[:, 1:]], axis=1)
    return jacobian, parts


def by_gls(fit: Fit, errors: ErrorModel) -> Estimates:
    """Values by generalised least squares under Σ, with intervals to first order.

    Args:
        fit: The fit.
        errors: Σ, and the parameters that are most probable under it.
    """
    place = _place(fit, errors.u)
    _, jacobian = errors.observed.look(place.relative, np.zeros(place.relative.size))
    information = errors.covariance.inner(jacobian, jacobian)
    seen = errors.covariance.weighted(jacobian)
    spread = mean_spread(information, seen, errors.observed.parts, errors.believed())
    words = f"{LEVEL:g}, generalised least squares under errors of rig and laws (Σ by REML)"
    return _estimates(fit, place, spread, words)


def spread_of(
    H: Float[np.ndarray, "n n"],
    weights: Float[np.ndarray, "loop m n"],
    parts: Parts,
    sizes: Sizes,
    unsure: Float[np.ndarray, " name"] | None = None,
) -> Spread:
    """Covariance of an estimator under one Σ, and how well it is known.

    Args:
        H: Inverse of B; directions that it does not see get a standard deviation of 10⁴.
        weights: [L, m, n] G.
        parts: What Σ is made of.
        sizes: Standard deviations of its parts.
        unsure: [name] standard deviations of their logarithms by REML; as good as known if None.
    """
    one = Plausible(1.0, parts.lengths, parts.kernel, sizes, unsure)
    return mean_spread(H, weights, parts, (one,))


def mean_spread(
    H: Float[np.ndarray, "n n"],
    weights: Float[np.ndarray, "loop m n"],
    parts: Parts,
    believed: Sequence[Plausible],
) -> Spread:
    """Covariance of an estimator, averaged over Σs that may be right, and how well it is known.

    Args:
        H: Inverse of B; directions that it does not see get a standard deviation of 10⁴.
        weights: [L, m, n] G.
        parts: What one of them is made of; all but K_c is common to them.
        believed: Each Σ, with its weight.

    Source:
        Degrees of freedom: Satterthwaite, Biometrics Bulletin 2 (1946); with REML: Giesbrecht and
        Burns, Biometrics 41 (1985).  The sizes' errors are taken to be independent.
    """
    seen, unseen = directions_of(H)
    bread = seen @ seen.T
    covariance, deviations, freedoms = unseen @ unseen.T, [], []
    unknown = np.maximum(np.diagonal(covariance), 1e-300)
    for one in believed:
        origin = bread @ carried(one.of(parts), one.sizes, weights) @ bread
        covariance = covariance + one.weight * origin.sum(axis=0)
        share = np.diagonal(origin, axis1=1, axis2=2)
        variance = share.sum(axis=0) + unknown
        doubt = 2.0 * np.sum((share[1:] / variance * _unsure(one)[:, None]) ** 2, axis=0)
        freedoms.append(np.maximum(1.0 / np.maximum(doubt, 1e-12), LEAST_FREEDOM))
        deviations.append(np.sqrt(variance))
    weight = np.array([one.weight for one in believed])
    half = half_width(weight, np.array(deviations), np.array(freedoms), LEVEL)
    quantile = half / np.sqrt(np.maximum(np.diagonal(covariance), 1e-300))
    return Spread(covariance, np.diagonal(bread), quantile)


def _unsure(one: Plausible) -> Float[np.ndarray, " name"]:
    """Standard deviations of the logarithms of its sizes; zero where they are as good as known."""
    if one.spread is None:
        return np.zeros(len(NAMES))
    return np.hypot(one.spread, np.where(np.isin(NAMES, RIG), 0.0, OF_SHAPE))


def _place(fit: Fit, u: Float[np.ndarray, " n"]) -> _Place:
    valve = valve_at(fit.coordinates, jnp.asarray(u))
    free = fit.coordinates.free
    chosen = [(s, float(v)) for s, v in zip(specs(valve), np.asarray(values(valve)), strict=True)]
    declared = tuple(s for s, _ in chosen if s.symbol in free)
    theta = np.array([v for s, v in chosen if s.symbol in free])
    magnitude = magnitude_of(theta, declared)
    return _Place(
        valve, declared, Declared.beside(valve, fit.coordinates, magnitude), theta, magnitude
    )


def _estimates(
    fit: Fit,
    place: _Place,
    spread: Spread,
    words: str,
    found: dict[str, Profile] | None = None,
) -> Estimates:
    covariance = spread.covariance * np.outer(place.magnitude, place.magnitude)
    sd = np.sqrt(np.diagonal(covariance)).tolist()
    own = {
        s.symbol: (d, q)
        for s, d, q in zip(place.declared, sd, spread.quantile.tolist(), strict=True)
    }
    leader = dict(fit.coordinates.ties)
    parameters = []
    for spec, value in zip(specs(place.valve), np.asarray(values(place.valve)), strict=True):
        symbol = leader.get(spec.symbol, spec.symbol)
        e = estimate_of(spec, float(value), *own.get(symbol, (0.0, NORMAL)))
        profile = (found or {}).get(symbol)
        parameters.append(e if profile is None else _bent(spec, e, profile))
    symbols = fit.coordinates.free
    return Estimates(
        parameters=tuple(parameters),
        symbols=symbols,
        covariance=covariance,
        interval=words,
        undetermined=undetermined(symbols, place.theta, spread.covariance, parameters),
    )


def _bent(spec: ParamSpec, e: Estimate, profile: Profile) -> Estimate:
    """The same with the ends of its profile, or its bound where the data reach beyond that."""
    below, above = profile.closed
    low = profile.low if below or e.low > spec.low else spec.low
    high = profile.high if above or e.high < spec.high else spec.high
    ended = (below or e.low <= spec.low, above or e.high >= spec.high)
    close = all(ended) and near_enough(spec, e.value, low, high)
    low, high = float(min(low, e.value)), float(max(high, e.value))
    return replace(e, low=low, high=high, identified=close and e.identified)


def _one_end(profile: Profile) -> str:
    """What remains known of a parameter that may go on without end on a side."""
    below, above = profile.closed
    if not below and not above:
        return f"no end of {profile.symbol} was found on either side"
    end = f"at least {profile.low:.3g}" if below else f"at most {profile.high:.3g}"
    unit = profile.declared.unit
    return f"one end of {profile.symbol} was found only: {end}{'' if unit == '-' else ' ' + unit}"
