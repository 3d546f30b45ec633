from dataclasses import replace

import numpy as np
import pytest

from sysid.likelihood.observed import observe
from sysid.uncertainty.error_model import error_model
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
