"""W11's two columns without noise: what one card leaves, law by law."""

import jax.numpy as jnp
import numpy as np
import pytest
from w11_card import SYMBOLS, WIDTH, both, campaign, card, fit, power, truth

from sysid.models.generalized import HIGH_SYMMETRIC, LOW_SYMMETRIC, Generalized
from sysid.parameters import build


@pytest.fixture(scope="module")
def law():
    return fit({WIDTH})


def test_each_set_has_its_own_column():
    motion, high = campaign()
    force = truth()[0]
    for column, which in ((LOW_SYMMETRIC, ~high), (HIGH_SYMMETRIC, high)):
        expected = np.asarray(build(Generalized, column).force(motion))
        np.testing.assert_allclose(force[which], expected[which], rtol=1e-9, atol=1e-6)
        assert np.abs(force[~which] - expected[~which]).max() > 100.0
    np.testing.assert_allclose(np.asarray(card(jnp.asarray(both())).force(motion)), force)


def test_where_all_parameters_differ_nothing_is_left():
    assert fit(SYMBOLS, [both()]).mean < 1e-6


def test_beside_the_width_it_is_the_steepness(law):
    """A step that is broader at small amplitudes, by less than a constant travel asks for."""
    assert law.mean > 0.02
    steeper = fit({WIDTH, "k_0"}, [law.u])
    assert steeper.mean < 0.8 * law.mean
    assert 0.05 < power(steeper, "k_0") < 0.3
    for symbol in ("F_0", "k_2", "k_1c", "a_4", "a_1"):
        assert fit({WIDTH, symbol}, [law.u]).mean > 0.97 * law.mean, symbol


def test_the_exponent_is_that_of_the_diagnosis(law):
    assert power(law, WIDTH) == pytest.approx(0.56, abs=0.03)
