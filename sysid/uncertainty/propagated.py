r"""Intervals of fitted parameters from the errors that a campaign shows.

An estimator moves by δ = B Σ_l G_lᵀ e_l when the loops err by e, so with the covariance Σ of such
errors, found by REML,

    cov = B (Gᵀ Σ G) B

| estimator | G | B |
|---|---|---|
| least squares, Eq. 11 | w² J | (JᵀW J)⁻¹ |
| generalised least squares | Σ⁻¹ J | (JᵀΣ⁻¹J)⁻¹ |

and quantiles of Student's t, since Σ is estimated (`spread`).

The covariance belongs to the place that it is taken at, and a fit that happens to lie where an
estimator looks good believes itself: in Eq. 7 ln k_3 is known the better the smaller it was found.
So the standard deviation that a parameter has at the values that are most probable under Σ, which
come closer to the truth, must be small for the fitted value, too, as a parametric bootstrap would
ask.
"""

from dataclasses import replace
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops
from sysid.identification.families import family
from sysid.identification.problem import test_weights
from sysid.identification.result import Fit
from sysid.likelihood.discrepancy_parts import Parts
from sysid.models.damper import Damper
from sysid.parameters import ParamSpec, specs, values
from sysid.uncertainty.covariance import LEVEL, NORMAL, OPEN, estimate_of, near_enough
from sysid.uncertainty.determined import undetermined
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.estimate import Estimate, Estimates
from sysid.uncertainty.profiles import Profile, profiles_of_eq_11
from sysid.uncertainty.sample import observed_of
from sysid.uncertainty.spread import (
    Place,
    Spread,
    known_slopes,
    mean_spread,
    place_at,
    spread_under,
)

ALL: Final = 10_000
"""Harmonics: as many as the points carry, for Eq. 11 has them all."""


def by_eq_11(fit: Fit, loops: Loops, errors: ErrorModel, *, bent: bool = True) -> Estimates:
    """Intervals of the fitted values under the errors that the campaign shows.

    Where the model has no memory, ends are those of the profile of Eq. 11's own cost, scaled to
    the same standard deviation: a parameter whose profile stays low on a side is not identified,
    whatever its standard deviation at the optimum, and neither is one whose standard deviation at
    the most probable parameters under Σ is too large for its fitted value.

    Args:
        fit: The fit.
        loops: Those that were fitted.
        errors: Σ at the fit (`errors_at`).
        bent: Follow profiles; to first order otherwise.
    """
    place = place_at(fit.coordinates, np.asarray(fit.u))
    spread = _spread_of_eq_11(fit, loops, errors, place)
    probable = place_at(fit.coordinates, errors.u)
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


def _spread_of_eq_11(fit: Fit, loops: Loops, errors: ErrorModel, place: Place) -> Spread:
    """Of least squares, if the parameters are those of the place."""
    jacobian, parts = _in_all_harmonics(fit, loops, errors, place)
    weight = test_weights(loops, fit.weights)[:, None, None]
    weighted = weight * jacobian
    H = np.einsum("lmi,lmj->ij", weighted, weighted)
    return mean_spread(H, weight * weighted, parts, errors.believed())


def _held_against(
    estimates: Estimates, fit: Fit, place: Place, sd_there: Float[np.ndarray, " n"]
) -> Estimates:
    """Not identified, and said so, where another place's deviations are too large for the fit.

    Args:
        estimates: With what is identified at the fit.
        fit: The fit.
        place: Where it is.
        sd_there: [n] standard deviations, in the parameters' units, at the most probable
            parameters under Σ; held against the magnitudes of `place`, the fit's own.
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
    fit: Fit, loops: Loops, errors: ErrorModel, place: Place
) -> tuple[Float[np.ndarray, "loop m n"], Parts]:
    """Jacobian of the fitted model, and what Σ is made of, in as many harmonics as Eq. 11 has.

    Of a model with memory, which is computed at fewer points, in those that Σ was sought in.
    """
    observed = errors.observed
    if family(fit.model).memoryless:
        observed = observed_of(fit, loops, ALL)
    residual, jacobian = observed.look(place.relative, np.zeros(place.relative.size))
    jacobian = known_slopes(jacobian)
    parts = errors.observed.parts
    if observed is not errors.observed:
        parts = replace(
            observed.beside(
                Damper(place.valve), residual, apart=True,
                statics_free=place.relative.statics_free,
            ).parts,
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
    place, spread = spread_under(fit, errors)
    words = f"{LEVEL:g}, generalised least squares under errors of rig and laws (Σ by REML)"
    return _estimates(fit, place, spread, words)


def _estimates(
    fit: Fit,
    place: Place,
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
    low, high = profile.low, profile.high
    close = all(profile.ended(e.low, e.high)) and near_enough(spec, e.value, low, high)
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
