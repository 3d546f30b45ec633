import jax.numpy as jnp
import numpy as np
import pytest

from sysid.identification.families import FAMILIES
from sysid.models.coordinates import Reference
from sysid.models.generalized import ASYMMETRIC, LOW_SYMMETRIC, Generalized
from sysid.models.generalized_coordinates import GeneralizedCoordinates
from sysid.parameters import build
from sysid.uncertainty.prior import prior_of
from sysid.uncertainty.target import log_prior, parameters_at

REFERENCE = Reference(force=500.0, speed=0.4, current=0.4, length=0.025)


def prior_at(table, variant="asymmetric"):
    coordinates = GeneralizedCoordinates(REFERENCE, variant)
    u = np.asarray(coordinates.locate(build(Generalized, table)))
    return prior_of(coordinates, u), u


def test_every_declaration_is_said_in_words():
    prior, _ = prior_at(ASYMMETRIC)
    words = dict(line.split(" ", 1) for line in prior.words())
    assert list(words) == list(ASYMMETRIC)
    assert words["F_0"] == "[N]: log-normal, median 70, a factor of 10 either way"
    assert words["k_2"] == "[-]: Cauchy, half of it within ± 8, not below 0"
    assert words["I_0"] == (
        "[A]: Cauchy, half of it within ± 0.1, by the solver's coordinates a_2 I_0 within ± 15"
    )
    assert words["k_5"] == "[-]: Cauchy, half of it within ± 0.2, not below 0"


def test_parameters_are_those_of_the_table():
    prior, u = prior_at(ASYMMETRIC)
    found = dict(
        zip([s.symbol for s in prior.declared], parameters_at(prior, u[None])[0], strict=True)
    )
    assert found == pytest.approx(ASYMMETRIC, rel=1e-6)


def test_density_of_coordinates_is_that_of_the_declarations_times_the_change_of_volume():
    prior, u = prior_at(ASYMMETRIC)
    rng = np.random.default_rng(0)
    places = u + 0.3 * rng.standard_normal((5, 16))
    theta = parameters_at(prior, places)
    expected = np.zeros(5)
    for k, spec in enumerate(prior.declared):
        if spec.scale == "log":
            x = np.log(theta[:, k] / spec.typical) / np.log(10.0)
            expected -= 0.5 * x**2 + np.log(theta[:, k])
        else:
            expected -= np.log(1.0 + (theta[:, k] / spec.typical) ** 2)
    step = 1e-6 * np.eye(16)
    for j, place in enumerate(places):
        slopes = (parameters_at(prior, place + step) - parameters_at(prior, place - step)) / 2e-6
        expected[j] += np.linalg.slogdet(slopes)[1]
    found = log_prior(prior, places)
    assert np.ptp(found - expected) < 1e-4


def test_neither_large_nor_small_differences_are_preferred():
    """The density of ln θ falls alike on both sides of the typical magnitude."""
    prior, _ = prior_at(ASYMMETRIC)
    theta = np.array([spec.typical for spec in prior.declared])
    linear = np.array([spec.scale == "linear" for spec in prior.declared])
    for times in (2.0, 5.0, 30.0):
        above = np.asarray(prior._each(jnp.asarray(theta * times))) + np.log(times)
        below = np.asarray(prior._each(jnp.asarray(theta / times))) - np.log(times)
        np.testing.assert_allclose(above[linear], below[linear], atol=1e-9)
        assert np.all(above[linear] < np.asarray(prior._each(jnp.asarray(theta)))[linear])


def test_a_tied_parameter_is_counted_once_and_what_is_out_of_bounds_is_impossible():
    prior, u = prior_at(LOW_SYMMETRIC, "symmetric")
    assert "k_1e" not in [s.symbol for s in prior.declared]
    assert np.isfinite(log_prior(prior, u[None])[0])
    assert log_prior(prior, np.full((1, 13), np.nan))[0] == -np.inf


@pytest.mark.parametrize("kind", [z for z in FAMILIES if not z.tabled], ids=lambda z: z.name)
def test_where_coordinates_end_before_a_declaration_does_is_said(kind):
    """Of those parameters, and only those, that no coordinate alone takes far."""
    coordinates = kind.coordinates(REFERENCE, kind.variants[0])
    reach = 300.0 * np.concatenate([np.eye(coordinates.size), -np.eye(coordinates.size)])
    prior = prior_of(coordinates, np.zeros(coordinates.size))
    found = np.array([prior.parameters(jnp.asarray(u)) for u in reach])
    typical = np.array([spec.typical for spec in prior.declared])
    near = np.nanmax(np.abs(found), axis=0) < 60.0 * typical
    symbols = np.array([spec.symbol for spec in prior.declared])
    said = {line.split(" ")[0]: line for line in prior.words() if "coordinates" in line}
    products = {"I_0", "I_1"}  # times a_2, a_3; alone they go anywhere
    assert set(said) - products == set(symbols[near].tolist()) - products
    assert not products & set(symbols) - set(said)
    values = dict(zip(symbols, found.T, strict=True))
    if kind.name == "carreau":
        assert said["m"].endswith("by the solver's coordinates within 0.223 … 4.48")
        assert np.ptp(values["m"]) == pytest.approx(4.48 - 0.223, abs=0.01)
        assert said["i_s"].endswith("within 0.00733 … 21.8 A")
        assert values["i_s"].max() == pytest.approx(21.8, abs=0.05)
    if "q" in said:
        assert said["q"].endswith("within ± 37.5 1/A")
        assert np.abs(values["q"]).max() == pytest.approx(37.5)
