"""What an error of a base's laws would look like: its own laws, each times a factor."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.effects.force.gas_temperature import GasTemperature
from sysid.likelihood.discrepancy_parts import Parts
from sysid.likelihood.law_directions import (
    change_with_warmth,
    law_directions,
    stretched,
    yield_direction,
)
from sysid.models.base import AbstractValve
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.models.lumped import TABLE_1, Lumped
from sysid.motion.motion import sine_motion
from sysid.parameters import build
from tests.models.rival_examples import EXAMPLES

LOOPS = sine_motion(
    np.array([0.01, 0.01, 0.005]), np.array([8.0, 8.0, 4.0]), np.array([0.0, 0.4, 1.0]),
    np.array([75.0, 15.0, 45.0]), points=72,
)  # fmt: skip
POINTS = jnp.eye(72)
"""Harmonics or points, the columns are all the same."""
VALVES: dict[str, AbstractValve] = {
    "generalized": build(Generalized, LOW_SYMMETRIC),
    "lumped": build(Lumped, TABLE_1),
    **{name: build(kind, values) for name, (kind, values) in EXAMPLES.items()},
}


def scaled(valve: AbstractValve, names: tuple[str, ...], factor: float) -> np.ndarray:
    """Force, N, of the valve with some of its attributes times a factor."""
    other = eqx.tree_at(
        lambda v: [getattr(v, name) for name in names],
        valve,
        [factor * getattr(valve, name) for name in names],
    )
    return np.asarray(other.force(LOOPS))


@pytest.mark.parametrize("name", VALVES)
def test_they_are_changes_of_the_valve_s_own_laws(name):
    valve, step = VALVES[name], 1e-5
    directions = np.asarray(law_directions(Damper(valve), LOOPS, POINTS))
    for found, names in zip(directions, valve.laws.bent, strict=True):
        if not names:
            assert not found.any()
            continue
        expected = (scaled(valve, names, 1 + step) - scaled(valve, names, 1 - step)) / (2 * step)
        assert np.abs(expected).max() > 1.0
        np.testing.assert_allclose(found, expected, atol=1e-3 * np.abs(expected).max())


@pytest.mark.parametrize("name", VALVES)
def test_the_yield_force_errs_alone_where_the_valve_has_a_law_of_it(name):
    valve, step = VALVES[name], 1e-5
    found = np.asarray(yield_direction(Damper(valve), LOOPS, POINTS))
    names = valve.laws.yielding
    assert bool(names) == (name == "lumped")
    expected = (scaled(valve, names, 1 + step) - scaled(valve, names, 1 - step)) / (2 * step)
    np.testing.assert_allclose(found, expected, atol=1e-3 * max(np.abs(expected).max(), 1e-3))
    assert found.any() == bool(names)


def test_a_factor_on_a_law_of_the_generalised_model_is_one_on_what_the_paper_calls_it():
    valve = build(Generalized, LOW_SYMMETRIC)
    v_m, i = jnp.array([0.05, 0.3]), jnp.array([0.0, 0.4])
    other = stretched(valve, jnp.array([1.1, 1.2, 1.3]))
    assert isinstance(other, Generalized)
    np.testing.assert_allclose(other.loop_half_width(v_m, i), 1.1 * valve.loop_half_width(v_m, i))
    np.testing.assert_allclose(other.steepness(v_m), 1.2 * valve.steepness(v_m))
    np.testing.assert_allclose(other.transition_force(v_m), valve.transition_force(v_m))
    np.testing.assert_allclose(
        [other.k_1c, other.k_1e], [1.3 * valve.k_1c, 1.3 * valve.k_1e], rtol=1e-12
    )


def test_a_law_that_a_valve_lacks_has_no_size():
    force = np.asarray(VALVES["lumped"].force(LOOPS))
    laws = np.concatenate(
        [force[None], np.asarray(law_directions(Damper(VALVES["lumped"]), LOOPS, POINTS))]
    )
    parts = Parts(
        noise=np.ones(3), force=force, rate=force, scale=np.ones(3), order=np.arange(72),
        kernel=np.eye(3), laws=laws,
    )  # fmt: skip
    assert set(parts.absent) == {"steepness", "thermometer"}


def test_a_thermometer_that_errs_about_the_oil_does_not_err_about_the_gas():
    """Warmer oil is thinner and yields less; the mean force of a gas beside the valve stays."""
    valve, gas = VALVES["lumped"], GasTemperature(c_gT=1.5)
    warmer = eqx.tree_at(lambda m: m.temperature, LOOPS, LOOPS.temperature + 1e-3)
    assert np.ptp(np.asarray(Damper(valve, (gas,)).force(warmer)).mean(axis=1)) > 1.0
    expected = np.asarray(valve.force(warmer) - valve.force(LOOPS)) / 1e-3
    for effects in ((), (gas,)):
        found = np.asarray(change_with_warmth(Damper(valve, effects), LOOPS, POINTS))
        np.testing.assert_allclose(found, expected, atol=1e-3 * np.abs(expected).max())
    assert np.abs(expected).max() > 1.0
