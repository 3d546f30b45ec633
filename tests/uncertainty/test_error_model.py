from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest
from scipy.stats import chi2

from sysid.identification.fit import fit_loops
from sysid.likelihood.gls import Bound, gauss_newton
from sysid.likelihood.observed import observe
from sysid.likelihood.settling import settled
from sysid.models.coordinates import place_of, valve_at
from sysid.models.damper import Damper
from sysid.models.generalized import Generalized
from sysid.parameters import build, specs
from sysid.rig.trial_campaign import make_trial
from sysid.rig.trial_design import TrialDesign
from sysid.uncertainty.error_model import ErrorModel, error_model, errors_at, errors_at_best
from sysid.uncertainty.sample import observed_of
from sysid.uncertainty.target import exact_log_likelihood


def width(errors) -> float:
    """Mean variance of the well-known directions, on a log scale."""
    values = np.linalg.eigvalsh(errors.information)
    return float(-np.log(values[-5:]).mean())


def test_noise_of_independent_harmonics_is_what_the_residual_shows(made):
    residual, _ = made.errors.observed.look(made.fit.coordinates, made.errors.u)
    white = made.errors.covariance.whiten(residual[:, :, None])
    freedom = residual.size - made.errors.u.size
    assert float(np.sum(white**2)) == pytest.approx(freedom, rel=1e-6)
    # 2 % of noise over 4 cycles of 360 points, in parts of each test's RMS force
    noise = made.errors.observed.parts.noise / made.errors.observed.parts.scale
    assert np.median(noise) == pytest.approx(0.02 / np.sqrt(4 * 360), rel=0.2)


def test_more_errors_are_admitted_the_wider_the_posterior(made):
    kinds = ("independent", "random_effects", "full", "power")
    found = {kind: error_model(made.fit, observe(made.loops), kind) for kind in kinds}
    assert width(found["independent"]) < width(found["random_effects"])
    assert width(found["independent"]) < width(found["full"])
    assert found["random_effects"].sizes.odd == found["random_effects"].sizes.scale == 0.0
    assert "gain" in found["random_effects"].words
    assert found["full"].sizes.odd > 0.0
    # where the model is right and noise is white, there is nothing to temper
    assert 0.3 < found["power"].power <= 1.0


def test_exact_likelihood_is_the_quadratic_form_and_power_scales_it(made):
    rng = np.random.default_rng(0)
    u = made.errors.u + 0.01 * rng.standard_normal((3, made.errors.u.size))
    whole = exact_log_likelihood(made.prior, made.errors, u)
    for k in range(3):
        r = made.errors.observed.residual(made.fit.coordinates, u[k])[:, :, None]
        assert whole[k] == pytest.approx(-0.5 * made.errors.covariance.inner(r, r)[0, 0], rel=1e-9)
    half = exact_log_likelihood(made.prior, replace(made.errors, power=0.5), u)
    assert half == pytest.approx(0.5 * whole)


@pytest.fixture(scope="module")
def departed():
    """A campaign whose laws are wrong by 4 %: Σ at the fit, and at the most probable parameters."""
    trial = make_trial(61_000_108, design=TrialDesign(fewest=110, most=110, misfit=0.041))
    fit = fit_loops(trial.loops, variant="symmetric")
    observed = observed_of(fit, trial.loops)
    near = errors_at(fit, observed)
    values = {s.symbol: trial.truth.parameters[s.symbol] for s in specs(Generalized)}
    truth = np.asarray(place_of(fit.coordinates, build(Generalized, values)))
    return fit, observed, near, truth


def test_sigma_at_the_most_probable_parameters_does_not_exclude_the_truth(departed):
    """How laws change a loop at Eq. 11's values is too far from how they do at the truth."""
    fit, observed, near, truth = departed
    chance = float(chi2.ppf(0.999, truth.size))

    def score(errors: ErrorModel) -> float:
        """rᵀΣ⁻¹J (JᵀΣ⁻¹J)⁻¹ JᵀΣ⁻¹r at the truth: χ² if Σ is that of its residual."""
        residual, jacobian = errors.observed.look(fit.coordinates, truth)
        both = np.concatenate([jacobian, residual[:, :, None]], axis=2)
        gram = errors.covariance.inner(jacobian, both)
        return float(gram[:, -1] @ np.linalg.pinv(gram[:, :-1], hermitian=True) @ gram[:, -1])

    best = errors_at_best(fit, observed, near)
    full = error_model(fit, observed, near=best)
    assert score(near) > 1.5 * chance
    assert score(best) < chance
    assert score(full) < chance
    # what parameters under Σ may leave is still counted from what least squares leaves
    assert best.observed.parts.error == near.observed.parts.error


def test_sigma_stays_at_the_fit_where_parameters_under_it_have_wandered(departed):
    fit, observed, near, _ = departed
    lost = replace(near, u=near.u + 5.0)
    assert errors_at_best(fit, observed, lost) is lost


@pytest.mark.parametrize("free", [True, False])
def test_static_forces_that_a_model_leaves_free_are_not_what_it_leaves(made, monkeypatch, free):
    """Limits of Σ and of its fits are those of loops without the rig's preload, or of all of it."""
    coordinates, u = made.fit.coordinates, np.asarray(made.fit.u)
    monkeypatch.setattr(type(coordinates), "statics_free", property(lambda self: free))
    preload = np.linspace(100.0, 300.0, len(made.loops.ids))[:, None]
    seen = []

    class SeenError(Exception):
        """A bound was asked for."""

    def asked(*_, bound, **__):
        seen.append(bound)
        raise SeenError

    monkeypatch.setattr("sysid.likelihood.settling.gauss_newton", asked)
    for loops in (made.loops, replace(made.loops, force=made.loops.force + preload)):
        observed = observe(loops, points=72)
        residual = observed.residual(coordinates, u)
        damper = Damper(valve_at(coordinates, jnp.asarray(u)))
        own = observed.beside(damper, residual, statics_free=free)
        seen.append(own.parts.error)
        with pytest.raises(SeenError):
            settled(own, coordinates, u)
        bound = seen.pop()
        seen += [bound.most, bound.left(residual)]
    plain, loaded = np.array(seen).reshape(2, 3)
    if free:
        np.testing.assert_allclose(loaded, plain, rtol=1e-9)
    else:
        assert (loaded > 3.0 * plain).all()


def test_a_bound_without_the_first_coefficients_holds_a_fit_by_the_rest(made):
    """Where the rest fits, however large the first are; it would be refused if all counted."""
    coordinates, u = made.fit.coordinates, np.asarray(made.fit.u)
    observed = observe(made.loops, points=72)
    covariance = made.errors.covariance
    covariance = type(covariance)(observed.parts, made.errors.sizes)

    def look(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        residual, jacobian = observed.look(coordinates, z)
        return residual + 1e3 * (observed.basis.order == 0), jacobian

    weight = np.ones(observed.tests)
    rest = Bound(weight, 0.0, 1).left(look(u)[0])
    held = gauss_newton(look, u, covariance, bound=Bound(weight, 1.5 * rest, 1))
    assert Bound(weight, 0.0, 1).left(held.residual) <= 1.5 * rest * (1.0 + 1e-9)
    with pytest.raises(ValueError, match="starts"):
        gauss_newton(look, u, covariance, bound=Bound(weight, 1.5 * rest))
