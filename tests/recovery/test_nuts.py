"""emcee's draws against those of another sampler, and the test that compares them."""

import numpy as np
import pytest
from marginals import agreement

from sysid.identification.fit import fit_loops
from sysid.likelihood.observed import observe
from sysid.uncertainty.error_model import error_model
from tests.identification.campaigns import LOW_DESIGN, virtual_loops
from tests.uncertainty.conftest import PASSIVE


def chains(seed: int, *, width: float = 1.0, beside: float = 0.0) -> np.ndarray:
    """Four autocorrelated chains of three normal quantities."""
    rng = np.random.default_rng(seed)
    x = np.empty((4, 3000, 3))
    x[:, 0] = rng.standard_normal((4, 3))
    for t in range(1, x.shape[1]):
        x[:, t] = 0.8 * x[:, t - 1] + 0.6 * rng.standard_normal((4, 3))
    return beside + width * x


def test_samples_of_one_density_agree_and_their_differences_are_as_large_as_said():
    found = [agreement(chains(2 * k), chains(2 * k + 1)) for k in range(20)]
    assert all(one.agrees for one in found)
    assert np.sqrt(np.mean([one.z**2 for one in found])) == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize(
    "change", [{"width": 1.2}, {"width": 0.85}, {"beside": 0.2}], ids=["wide", "narrow", "beside"]
)
def test_samples_of_other_densities_do_not(change):
    assert not any(agreement(chains(2 * k), chains(2 * k + 1, **change)).agrees for k in range(5))


@pytest.mark.slow
def test_nuts_draws_from_the_same_posterior():
    pytest.importorskip("numpyro", reason="needs the extra: pip install -e '.[nuts]'")
    from nuts import by_emcee, by_nuts, dispersed

    loops = virtual_loops(PASSIVE, LOW_DESIGN, (0.0,), noise=0.02, seed=4)
    fit = fit_loops(loops, variant="passive", weights="peak")
    errors = error_model(fit, observe(loops), "independent")

    emcee, ready = by_emcee(errors, fit, 600.0)
    assert emcee.words == "converged"
    # fewer chains that learn the scales for a shorter time say that they know more than they do
    other = by_nuts(ready.target, dispersed(emcee, 4), 500, 500)
    assert other.words == "0 divergent transitions"
    found = agreement(emcee.u, other.u)
    assert found.agrees, found.words()
    narrower = np.median(other.u, axis=(0, 1)) + 0.8 * (other.u - np.median(other.u, axis=(0, 1)))
    assert not agreement(emcee.u, narrower).agrees
