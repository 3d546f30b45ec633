import numpy as np
import pytest
from scipy.signal import lfilter

from sysid.uncertainty.convergence import convergence

ENSEMBLES, STEPS, WALKERS = 4, 1500, 8


def autoregressive(memory: float, seed: int = 0) -> np.ndarray:
    """[e, t, w] of unit variance, whose autocorrelation at lag k is memory^k."""
    rng = np.random.default_rng(seed)
    shape = (ENSEMBLES, STEPS, WALKERS)
    noise = np.sqrt(1.0 - memory**2) * rng.standard_normal(shape)
    noise[:, 0] = rng.standard_normal(shape[::2])
    return lfilter([1.0], [1.0, -memory], noise, axis=1)


def test_time_and_sample_size_of_a_process_that_has_a_closed_form():
    found = convergence(autoregressive(0.8)[..., None], ["x"])
    tau = (1.0 + 0.8) / (1.0 - 0.8)
    assert found.tau[0] == pytest.approx(tau, rel=0.15)
    assert found.bulk[0] == pytest.approx(ENSEMBLES * STEPS * WALKERS / tau, rel=0.15)
    assert found.rhat[0] < 1.005
    assert found.reached
    assert found.missing == ()


def test_an_ensemble_in_another_place_is_seen_however_long_it_is():
    draws = autoregressive(0.5)
    draws[2] += 0.6
    found = convergence(draws[..., None], ["k_3"])
    assert found.rhat[0] > 1.02
    assert not found.reached
    assert "k_3 differ between ensembles" in found.missing[0]


def test_an_ensemble_that_is_too_wide_or_too_narrow_is_seen_though_its_mean_is_right():
    right = convergence(autoregressive(0.5)[..., None], ["x"]).rhat[0]
    for factor in (0.5, 2.0):
        draws = autoregressive(0.5)
        draws[1] *= factor
        assert convergence(draws[..., None], ["x"]).rhat[0] > 1.02 > right


def test_a_chain_that_is_too_short_for_its_memory_is_refused():
    found = convergence(autoregressive(0.99)[..., None], ["x"])
    assert 50 * found.tau[0] > STEPS
    assert not found.reached
    assert any("need a longer chain" in sentence for sentence in found.missing)


def test_walkers_that_do_not_move_and_chains_of_no_length_say_so():
    draws = autoregressive(0.5)
    draws[0, :, 3] = 0.1
    assert not convergence(draws[..., None], ["x"]).reached
    few = convergence(autoregressive(0.5)[:, :4, :, None], ["x"])
    assert few.missing == ("4 steps are too few to say anything",)
