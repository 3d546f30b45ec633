"""Solver coordinates: there and back, inside the bounds, independent of units."""

import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sysid.models.coordinates import Reference
from sysid.models.generalized import ASYMMETRIC, HIGH_SYMMETRIC, LOW_SYMMETRIC, Generalized
from sysid.models.generalized_coordinates import VARIANTS, GeneralizedCoordinates
from sysid.motion.motion import sine_motion
from sysid.parameters import as_dict, build, specs

REFERENCE = Reference(force=800.0, speed=0.39, current=0.4, length=0.025)
FREE = {"asymmetric": 16, "symmetric": 13, "passive": 7, "mean": 9}


def of_variant(variant):
    table = dict(ASYMMETRIC if variant == "asymmetric" else LOW_SYMMETRIC)
    if variant == "passive":
        table.update(dict.fromkeys(("k_2", "k_3", "a_2", "a_3", "I_0", "I_1"), 0.0))
    if variant == "mean":
        table.update(k_4=0.0, k_3=0.0, a_3=0.0, I_1=0.0)
    return table


@pytest.mark.parametrize("variant", VARIANTS)
def test_there_and_back(variant):
    coordinates = GeneralizedCoordinates(REFERENCE, variant)
    table = of_variant(variant)
    u = coordinates.locate(build(Generalized, table))
    assert u.shape == (coordinates.size,) == (FREE[variant],)
    found = as_dict(coordinates.valve(u))
    for symbol, value in table.items():
        assert found[symbol] == pytest.approx(value, rel=1e-9, abs=1e-12), symbol


@pytest.mark.parametrize("variant", VARIANTS)
def test_size_counts_the_free_symbols(variant):
    coordinates = GeneralizedCoordinates(REFERENCE, variant)
    assert len(coordinates.free) == coordinates.size


@settings(max_examples=100, deadline=None)
@given(st.lists(st.floats(-8, 8), min_size=16, max_size=16), st.sampled_from(VARIANTS))
def test_any_numbers_give_a_model_inside_its_bounds(numbers, variant):
    coordinates = GeneralizedCoordinates(REFERENCE, variant)
    valve = coordinates.valve(jnp.array(numbers[: coordinates.size]))
    for spec in specs(Generalized):
        assert spec.check(float(getattr(valve, spec.symbol))) is None
    force = valve.force(sine_motion(0.0125, 2.5, 0.2))
    assert np.isfinite(np.asarray(force)).all()


@pytest.mark.parametrize("table", [LOW_SYMMETRIC, HIGH_SYMMETRIC, ASYMMETRIC])
def test_units_do_not_matter(table):
    """Forces × 30, speeds × 0.2 and milliamperes leave the coordinates where they are."""
    force, speed, current = 30.0, 0.2, 1000.0
    scale = {"F_0": force, "I_0": current, "I_1": current, "a_2": 1 / current, "a_3": 1 / current}
    scale |= dict.fromkeys(("a_0", "a_1", "a_4", "k_0", "k_1c", "k_1e"), 1 / speed)
    scaled = {symbol: value * scale.get(symbol, 1.0) for symbol, value in table.items()}
    there = GeneralizedCoordinates(REFERENCE, "asymmetric")
    elsewhere = GeneralizedCoordinates(
        Reference(800.0 * force, 0.39 * speed, 0.4 * current, 0.025 * speed), "asymmetric"
    )
    np.testing.assert_allclose(
        there.locate(build(Generalized, table)),
        elsewhere.locate(build(Generalized, scaled)),
        atol=1e-9,
    )
