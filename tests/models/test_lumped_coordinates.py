"""Coordinates of the lumped model: what is free, at which currents and temperatures."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.errors import FitError
from sysid.models.coordinates import Reference, place_of, reference_current, valve_at
from sysid.models.levels import Levels, levels_of
from sysid.models.lumped import CURRENTS, TABLE_1, Lumped
from sysid.models.lumped_coordinates import LUMPED_VARIANTS, lumped_coordinates
from sysid.models.simulate import simulate
from sysid.motion.motion import sine_motion
from sysid.motion.time_motion import time_motion
from sysid.parameters import as_dict, build, specs

REFERENCE = Reference(force=1000.0, speed=0.5, current=1.0, length=0.01)
VALVE = build(Lumped, TABLE_1)
LOOPS = sine_motion(
    np.array([0.01, 0.005]), np.array([8.0, 4.0]), np.array([0.9, 0.1]), np.array([15.0, 75.0]), 72
)


def levels(*currents: float, cold: float = 15.0, warm: float = 75.0) -> Levels:
    return Levels(currents or CURRENTS, (cold, warm), untold=0, tests=24)


@pytest.mark.parametrize("variant", LUMPED_VARIANTS)
def test_there_and_back(variant):
    coordinates = lumped_coordinates(REFERENCE, levels(), variant)
    u = place_of(coordinates, VALVE)
    assert u.shape == (coordinates.size,) == ((28,) if variant == "full" else (26,))
    assert float(jnp.abs(u).max()) < 5.0
    assert as_dict(valve_at(coordinates, u)) == pytest.approx(TABLE_1, rel=1e-9)


@pytest.mark.parametrize("variant", LUMPED_VARIANTS)
def test_free_symbols_are_those_that_move_in_the_order_of_declaration(variant):
    coordinates = lumped_coordinates(REFERENCE, levels(0.0, 0.5), variant)
    declared = [spec.symbol for spec in specs(Lumped, {"currents": (0.0, 0.5)})]
    some, other = (
        as_dict(valve_at(coordinates, jnp.full(coordinates.size, z))) for z in (0.1, -0.4)
    )
    # equal steps of both ends leave slopes alone
    other |= as_dict(valve_at(coordinates, jnp.linspace(-1.0, 1.0, coordinates.size)))
    assert coordinates.free == tuple(s for s in declared if some[s] != other[s])


def test_one_temperature_leaves_the_slopes_out_and_says_so():
    coordinates = lumped_coordinates(REFERENCE, levels(cold=40.0, warm=40.6), "paper")
    assert coordinates.size == 13
    assert not any("slope" in symbol for symbol in coordinates.free)
    assert any("slopes are held at zero" in remark for remark in coordinates.remarks)
    found = as_dict(valve_at(coordinates, place_of(coordinates, VALVE)))
    assert all(found[s] == 0.0 for s in found if "slope" in s)
    assert found["k.intercept"] == pytest.approx(1.5e6 + 40.3 * 1.5e5, rel=1e-12)
    warm = lumped_coordinates(REFERENCE, levels(), "paper")
    assert not any("slopes" in remark for remark in warm.remarks)


def test_temperatures_that_only_some_tests_know_are_refused():
    told = Levels(CURRENTS, (15.0, 75.0), untold=3, tests=24)
    with pytest.raises(FitError, match="3 of 24 tests have no temperature"):
        lumped_coordinates(REFERENCE, told, "paper")


def test_any_numbers_give_an_element_that_can_be_solved():
    coordinates = lumped_coordinates(REFERENCE, levels(), "full")
    rng = np.random.default_rng(5)
    for scale in (0.0, 1.0, 3.0):
        valve = valve_at(coordinates, jnp.asarray(scale * rng.standard_normal(coordinates.size)))
        assert all(s.check(v) is None for s, v in zip(specs(valve), as_dict(valve).values()))  # noqa: B905
        assert np.isfinite(np.asarray(simulate(valve, LOOPS))).all()


def test_units_do_not_matter():
    elsewhere = Reference(30.0 * 1000.0, 0.2 * 0.5, 1.0, 0.2 * 0.01)
    scale = {"k": 150.0, "C_post": 150.0, "C_pre": 150.0, "F_y": 30.0, "m_l": 150.0, "tau": 1.0}
    changed = {s: v * scale[s.partition("[")[0].partition(".")[0]] for s, v in TABLE_1.items()}
    here = place_of(lumped_coordinates(REFERENCE, levels(), "full"), VALVE)
    there = place_of(lumped_coordinates(elsewhere, levels(), "full"), build(Lumped, changed))
    np.testing.assert_allclose(here, there, atol=1e-9)


def test_derivatives_meet_central_differences():
    coordinates = lumped_coordinates(REFERENCE, levels(0.0, 1.0), "full")
    force = jax.jit(lambda z: coordinates.valve(z).force(LOOPS).ravel())
    u = place_of(coordinates, valve_at(coordinates, jnp.full(coordinates.size, 0.2)))
    slopes = np.asarray(jax.jit(jax.jacfwd(force))(u))
    for k, shift in enumerate(1e-5 * np.eye(u.size)):
        expected = np.asarray(force(u + shift) - force(u - shift)) / 2e-5
        np.testing.assert_allclose(
            slopes[:, k], expected, atol=1e-3 * np.abs(slopes).max(axis=0)[k]
        )


def test_currents_are_settings_of_the_supply():
    measured = np.array([0.003, 0.0, 0.7991, 0.8013, 0.25, 0.25, 1.996, -2.003])
    motion = sine_motion(0.01, 8.0, measured, np.linspace(11.0, 74.0, 8), points=4)
    found = levels_of([motion])
    assert found.currents == (0.0, 0.25, 0.8, 2.0)
    assert (found.temperatures, found.untold, found.tests) == ((11.0, 74.0), 0, 8)
    unknown = levels_of([motion, sine_motion(0.01, 8.0, 0.0, points=4)])
    assert (unknown.temperatures, unknown.untold) == ((11.0, 74.0), 1)
    assert levels_of([sine_motion(0.01, 8.0, 0.333, points=4)]).currents == (0.333,)


def test_a_supply_that_is_off_has_one_setting():
    """However its meter wanders: four settings of microamperes are nobody's table."""
    idle = np.array([3.8e-7, 4.1e-6, -6e-6, 1.3e-5])
    assert levels_of([sine_motion(0.01, 8.0, idle, points=4)]).currents == (0.0,)
    assert reference_current(idle) == 1.0
    assert reference_current(np.array([0.0, -0.4])) == 0.4


def test_where_no_test_keeps_its_current_the_table_spans_what_it_went_through():
    t = np.linspace(0.0, 1.0, 50)
    motion = time_motion(t, 0.01 * np.sin(9 * t), current=0.4 + 0.8 * t, temperature=20.0 + t)
    whole = jax.tree.map(lambda z: np.asarray(z)[None], motion)
    found = levels_of([whole])
    assert found.currents == (0.4, 0.6, 0.8, 1.0, 1.2)
    assert found.temperatures == (20.0, 21.0)


def test_one_current_is_a_table_too():
    valve = valve_at(lumped_coordinates(REFERENCE, levels(0.5), "paper"), jnp.zeros(6))
    assert "C_post[0.5 A].slope" in as_dict(valve)
    force = np.asarray(simulate(valve, LOOPS))
    other = sine_motion(
        np.array([0.01, 0.005]), np.array([8.0, 4.0]), 0.5, np.array([15.0, 75.0]), 72
    )
    np.testing.assert_array_equal(force, simulate(valve, other))
