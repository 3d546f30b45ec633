r"""Likelihoods: what a right model would still leave of the measured loops.

| kind | residual of a test |
|---|---|
| independent | every harmonic on its own, all tests alike in the fit's own weights (Eq. 11) |
| random_effects | besides, a gain, an offset and a delay of each test |
| full | besides, smooth errors of the model's laws: the covariance Σ of a diagnosis |
| power | independent, but counted as fewer data: L^β, β from the scatter between conditions |

Sizes are found by REML and held; how little they are known is the matter of `doubt` and `spread`.
The first is what least squares believes, and covers far too rarely; it is there to compare with.
"""

from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Final, Literal

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from sysid.errors import FitError
from sysid.identification.conditions import conditions
from sysid.identification.problem import test_weights
from sysid.identification.result import Fit
from sysid.likelihood.discrepancy import LAWS, Covariance, Sizes
from sysid.likelihood.gls import GlsFit, gauss_newton
from sysid.likelihood.late import straightened_beside
from sysid.likelihood.observed import Observed
from sysid.likelihood.plausible import Plausible, plausible
from sysid.likelihood.reml import Restricted, fit_sizes
from sysid.likelihood.settling import settled
from sysid.likelihood.smoothness import Residual, smoothness_and_sizes
from sysid.models.coordinates import AbstractCoordinates, valve_at
from sysid.models.damper import Damper
from sysid.uncertainty.covariance import ENOUGH_CONDITIONS
from sysid.uncertainty.tempering import tempering

Likelihood = Literal["full", "random_effects", "independent", "power"]

_PASSES: Final = 3
_NEARLY: Final = 1e-2
"""Decrease of the cost that the fit under Σ at another place stops at: a tenth of a standard
error."""
WANDERED: Final = 10.0
"""Times of what least squares leaves from which parameters under Σ have wandered.  The generator's
own leave up to four times as much where its laws are not the model's."""
_FREE: Final = 1e3
"""Offset of a test, in RMS forces, where the model leaves static forces free."""


@dataclass(frozen=True)
class ErrorModel:
    """A likelihood, its sizes found.

    Attributes:
        kind: Which.
        observed: Measured loops, with what Σ is made of at this model.
        sizes: Of the parts of Σ.
        covariance: Σ.
        power: β; 1 but for the power likelihood.
        u: [n] most probable parameters under Σ.
        information: [n, n] β JᵀΣ⁻¹J there.
        words: What it assumes, in a sentence.
        spread: [name] standard deviation of ln size; None where sizes were not sought by REML.
        plausible: Σs that may be right, those of `errors_at` and `errors_at_best`, and of the full
            likelihood near them; none of others.
    """

    kind: Likelihood
    observed: Observed
    sizes: Sizes
    covariance: Covariance
    power: float
    u: Float[np.ndarray, " n"]
    information: Float[np.ndarray, "n n"]
    words: str
    spread: Float[np.ndarray, " name"] | None = None
    plausible: tuple[Plausible, ...] = ()

    def believed(self) -> tuple[Plausible, ...]:
        """All Σs that may be right, or the only one."""
        parts = self.observed.parts
        alone = Plausible(1.0, parts.lengths, parts.kernel, self.sizes, self.spread)
        return self.plausible or (alone,)


def error_model(
    fit: Fit, observed: Observed, kind: Likelihood = "full", near: ErrorModel | None = None
) -> ErrorModel:
    """Find the sizes of a likelihood at a fit.

    Args:
        fit: Where to start, and what the tests' weights were.
        observed: The loops that were fitted.
        kind: Which likelihood.
        near: What `errors_at_best` found, for the full one; sought here if None.

    Raises:
        FitError: Weights by noise, where there is no noise floor; a power by one test.
    """
    if kind == "full":
        if near is None:
            near = errors_at_best(fit, observed, errors_at(fit, observed))
        return _full(fit, near)
    if kind == "random_effects":
        return _random_effects(fit, observed)
    plain = _independent(fit, observed)
    return plain if kind == "independent" else _power(fit, plain)


def errors_at(fit: Fit, observed: Observed) -> ErrorModel:
    """The full Σ as it is at the fit itself, and the parameters that are most probable under it.

    Cheaper than the full likelihood, for which Σ and the parameters are found in turns.  Errors of
    the laws have no bound here (`likelihood.reml.TIMES`): parameters do not wander.

    Args:
        fit: The fit.
        observed: The loops that were fitted.
    """
    return _taken_at(fit.coordinates, np.asarray(fit.u), observed)


def errors_at_best(fit: Fit, observed: Observed, near: ErrorModel) -> ErrorModel:
    """The same at the parameters that are most probable under Σ.

    Σ knows errors of the laws to first order, by how a loop changes with a law (`Parts.laws`).
    Where laws are wrong Eq. 11's values are so far from the truth that these changes differ by more
    than the noise, and Σ there would exclude the truth.  The most probable values are nearer.

    Args:
        fit: The fit.
        observed: The loops that were fitted.
        near: Σ at the fit (`errors_at`).

    Returns:
        Σ there, or `near` where the parameters have wandered: a loose Σ hardly holds them.
    """
    most = WANDERED * near.observed.parts.error
    residual = near.observed.residual(fit.coordinates, near.u)
    if near.observed.relative(residual, statics_free=fit.coordinates.statics_free) > most:
        return near
    best = _taken_at(fit.coordinates, near.u, observed)
    parts = replace(best.observed.parts, error=near.observed.parts.error)
    return replace(best, observed=replace(best.observed, parts=parts))


def _taken_at(
    coordinates: AbstractCoordinates[Any], u: Float[np.ndarray, " n"], observed: Observed
) -> ErrorModel:
    """Σ with the changes that loops have with the laws at u, and the parameters under it."""
    observed, sizes = straightened_beside(_beside(coordinates, u, observed), coordinates, u)
    observed, rough = smoothness_and_sizes(observed, coordinates, u, sizes, times=np.inf)
    look = partial(observed.look, coordinates)
    left = Residual(observed, *look(u), np.inf)
    restricted = fit_sizes(
        observed.parts, left.residual, left.jacobian, rough.sizes, times=left.times
    )
    gls = gauss_newton(look, u, restricted.covariance, tolerance=_NEARLY)
    found = _with_laws(observed, gls, restricted)
    return replace(found, plausible=plausible(left, restricted))


def _full(fit: Fit, near: ErrorModel) -> ErrorModel:
    gls, restricted = settled(near.observed, fit.coordinates, near.u, near.covariance)
    found = _with_laws(near.observed, gls, restricted)
    words = f"{found.words}; not taken for known, nor how smooth errors of the laws are"
    return replace(found, plausible=near.plausible, words=words)


def _with_laws(observed: Observed, gls: GlsFit, restricted: Restricted) -> ErrorModel:
    return ErrorModel(
        "full",
        observed,
        restricted.sizes,
        restricted.covariance,
        1.0,
        gls.u,
        gls.information,
        f"full covariance by REML: {_sizes_words(restricted.sizes)}",
        restricted.spread,
    )


def _random_effects(fit: Fit, observed: Observed) -> ErrorModel:
    """Noise is enlarged until Σ is as large as the residual: it has nothing for errors of laws."""
    u = np.asarray(fit.u)
    observed = _beside(fit.coordinates, u, observed)
    absent, look = ("odd", "even", *LAWS), partial(observed.look, fit.coordinates)
    residual, jacobian = look(u)
    sizes, larger = None, 1.0
    for _ in range(_PASSES):
        restricted = fit_sizes(observed.parts, residual, jacobian, sizes, absent)
        sizes = restricted.sizes
        gls = gauss_newton(look, u, restricted.covariance)
        u, residual, jacobian = gls.u, gls.residual, gls.jacobian
        factor = max(1.0 / larger, np.sqrt(gls.cost / (residual.size - u.size)))
        larger *= factor
        parts = replace(observed.parts, noise=factor * observed.parts.noise)
        observed = replace(observed, parts=parts)
    assert sizes is not None
    covariance = Covariance(observed.parts, sizes)
    words = (
        f"a gain, an offset and a delay of each test by REML: {_sizes_words(sizes)}; "
        f"noise {larger:.3g} × that between cycles"
    )
    return ErrorModel(
        "random_effects",
        observed,
        sizes,
        covariance,
        1.0,
        u,
        covariance.inner(jacobian, jacobian),
        words,
    )


def _independent(fit: Fit, observed: Observed) -> ErrorModel:
    weight = test_weights(observed.loops, fit.weights)
    offset = _FREE * float(observed.parts.scale.max()) if fit.coordinates.statics_free else 0.0
    sizes = Sizes(gain=0.0, offset=offset, delay=0.0)
    look = partial(observed.look, fit.coordinates)
    # of the size of the residual from the start, or the fit would end before it has begun
    left = float(np.sqrt(np.mean((weight[:, None] * look(np.asarray(fit.u))[0]) ** 2)))
    about = replace(observed.parts, noise=left / weight)
    gls = gauss_newton(look, np.asarray(fit.u), Covariance(about, sizes))
    fitted = gls.u.size + (len(weight) if offset else 0)
    noise = float(np.sqrt(gls.cost / (gls.residual.size - fitted)))
    observed = replace(observed, parts=replace(about, noise=noise * about.noise))
    covariance = Covariance(observed.parts, sizes)
    own = ", with a static force of each test" if offset else ""
    words = f'independent harmonics, all tests alike in the weights "{fit.weights}"{own}'
    return ErrorModel(
        "independent", observed, sizes, covariance, 1.0, gls.u, gls.information / noise**2, words
    )


def _power(fit: Fit, plain: ErrorModel) -> ErrorModel:
    residual, jacobian = plain.observed.look(fit.coordinates, plain.u)
    cluster, name = _clusters(plain.observed)
    if len(np.unique(cluster)) < 2:
        raise FitError(
            "The power likelihood is tempered by the scatter between tests, and there is one test",
            advice="Give it more tests, or choose another --likelihood.",
        )
    weighted = plain.covariance.weighted(jacobian)
    power = tempering(
        np.einsum("lmn,lm->ln", weighted, residual),
        np.einsum("lmi,lmj->lij", weighted, jacobian),
        cluster,
    )
    words = f"{plain.words}; likelihood to the power {power:.3g}, by the scatter between {name}"
    return replace(
        plain, kind="power", power=power, information=power * plain.information, words=words
    )


def _clusters(observed: Observed) -> tuple[Int[np.ndarray, " loop"], str]:
    number = conditions(observed.loops)
    if int(number.max()) + 1 >= ENOUGH_CONDITIONS:
        return number, "conditions"
    return np.arange(observed.tests), "tests"


def _beside(
    coordinates: AbstractCoordinates[Any], u: Float[np.ndarray, " n"], observed: Observed
) -> Observed:
    residual, _ = observed.look(coordinates, u)
    damper = Damper(valve_at(coordinates, jnp.asarray(u)))
    return observed.beside(damper, residual, apart=True, statics_free=coordinates.statics_free)


def _sizes_words(sizes: Sizes) -> str:
    told = [
        f"gain {sizes.gain:.2%}", f"offset {sizes.offset:.2g} N",
        f"delay {1e3 * sizes.delay:.2g} ms",
    ]  # fmt: skip
    if sizes.thermometer > 0.0:
        told.append(f"thermometer {sizes.thermometer:.2g} K")
    for name, label in (
        ("odd", "odd harmonics"), ("even", "even harmonics"), ("scale", "scale of the force"),
        ("width", "loop width"), ("steepness", "steepness"), ("growth", "growth with speed"),
    ):  # fmt: skip
        size = getattr(sizes, name)
        if size > 0.0:
            told.append(f"{label} {size:.2%}")
    return ", ".join(told)
