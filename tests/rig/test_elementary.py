"""Own elementary functions against numpy's, which are right to an ulp or so."""

import numpy as np

from sysid.rig.elementary import cosine, exp, log10, logistic, sine, tanh_half


def test_exponential_is_accurate_over_the_range_used():
    x = np.linspace(-80.0, 80.0, 100_003)
    np.testing.assert_allclose(exp(x), np.exp(x), rtol=4e-16)
    assert exp(np.zeros(1))[0] == 1.0


def test_decimal_logarithm():
    x = np.concatenate([np.geomspace(1e-30, 1e30, 10_001), 1.0 + np.linspace(-1e-3, 1e-3, 999)])
    own = np.array([log10(z) for z in x.tolist()])
    np.testing.assert_allclose(own, np.log10(x), rtol=1e-15, atol=1e-18)
    assert log10(1.0) == 0.0


def test_sine_and_cosine_of_many_turns():
    turns = np.linspace(-12.0, 12.0, 100_003)
    # numpy gets the angle reduced by exact symmetry, so that 2π's own rounding plays no part
    reduced = turns - np.rint(turns)
    np.testing.assert_allclose(sine(turns), np.sin(2 * np.pi * reduced), rtol=0, atol=5e-16)
    np.testing.assert_allclose(cosine(turns), np.cos(2 * np.pi * reduced), rtol=0, atol=2e-15)


def test_sine_is_exactly_zero_at_half_turns_and_one_at_quarter_turns():
    half = np.arange(-20, 21) / 2
    assert np.all(sine(half) == 0.0)
    assert np.all(sine(np.arange(-10, 11) + 0.25) == 1.0)


def test_tanh_and_logistic():
    z = np.linspace(-120.0, 120.0, 50_001)
    np.testing.assert_allclose(tanh_half(z), np.tanh(z / 2), rtol=0, atol=3e-16)
    assert tanh_half(np.zeros(1))[0] == 0.0
    for value in (-40.0, -1.3, 0.0, 0.7, 12.0):
        assert abs(logistic(value) - 1 / (1 + np.exp(-value))) < 2e-16
