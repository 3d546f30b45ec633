"""Values of parameters, and deviations carried over from solver coordinates to first order."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.diagnosis.quantities import (
    added_force,
    effect_quantities,
    free_values,
    free_vector,
    sensible_covariance,
    within_ranges,
)
from sysid.effects.registry import effect_kind, make
from sysid.models.coordinates import valve_at
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.parameters import ParamSpec

DRAWS = 4000


def test_values_are_those_of_the_damper(spring_state):
    values = free_values(spring_state)
    damper = valve_at(spring_state.coordinates, jnp.asarray(spring_state.u))
    assert values.symbols[-1] == "gas_spring.k_g"
    assert values.values[-1] == pytest.approx(float(damper.effects[0].k_g))
    for symbol, value in zip(values.symbols[:-1], values.values, strict=False):
        assert value == pytest.approx(float(getattr(damper.valve, symbol)))


def test_deviations_are_those_of_draws_about_the_fit(spring_state):
    """A tenth of a standard error about, where first order is exact enough."""
    values = free_values(spring_state)
    information = spring_state.gls.information
    root = np.linalg.cholesky(np.linalg.inv(information))
    random = np.random.default_rng(4).standard_normal((DRAWS, root.shape[0]))
    coordinates = spring_state.coordinates

    def parameters(u):
        damper = coordinates.valve(u)
        valve = [getattr(damper.valve, s) for s in coordinates.valve_coordinates.free]
        return jnp.stack([*valve, damper.effects[0].k_g])

    drawn = np.asarray(jax.vmap(parameters)(jnp.asarray(spring_state.u + 0.1 * random @ root.T)))
    spread = 10.0 * drawn.std(axis=0)
    expected = np.sqrt(np.diagonal(values.covariance))
    np.testing.assert_allclose(spread, expected, rtol=4.0 / np.sqrt(2 * DRAWS))
    correlated = np.corrcoef(drawn.T)
    np.testing.assert_allclose(
        correlated, values.covariance / np.outer(expected, expected), atol=4 / np.sqrt(DRAWS)
    )


def test_intervals_are_normal_and_judged(spring_state):
    values = free_values(spring_state)
    ((stiffness,),) = effect_quantities(spring_state, values)
    assert (stiffness.symbol, stiffness.unit, stiffness.level) == ("k_g", "N/m", 0.95)
    assert stiffness.sd == pytest.approx(np.sqrt(values.covariance[-1, -1]))
    assert stiffness.high - stiffness.low == pytest.approx(2 * 1.96 * stiffness.sd, rel=1e-4)
    assert stiffness.identified


def test_an_effect_that_might_be_absent_is_not_called_determined(spring_state):
    small = spring_state.u.copy()
    small[-1] *= 1e-3
    absent = replace(spring_state, gls=replace(spring_state.gls, u=small))
    ((stiffness,),) = effect_quantities(absent, free_values(absent))
    assert stiffness.low < 0.0 < stiffness.high
    assert not stiffness.identified


def test_added_force_of_a_spring_is_its_stiffness_times_the_stroke(evidence, spring_state):
    stiffness = free_values(spring_state).values[-1]
    stroke = float(np.sqrt(np.mean(evidence.loops.displacement**2)))
    assert added_force(evidence, spring_state, 0) == pytest.approx(stiffness * stroke, rel=1e-6)


def test_a_parameter_at_the_end_of_its_range_is_known_no_better_there(evidence, base_state):
    """Its coordinate does not move it there, which says nothing about the data."""
    valve = base_state.coordinates.valve_coordinates
    coordinates = DamperCoordinates(valve, (make(effect_kind("gas_polytropic")),))
    place = list(coordinates.free).index("gas_polytropic.n_g")
    sds = []
    for share in (-4.0, -18.0):
        u = np.append(base_state.u, [1.0, 0.0, 0.0])
        u[place] = share
        residual, jacobian = evidence.look(coordinates, u)
        information = base_state.covariance.inner(jacobian, jacobian)
        gls = replace(base_state.gls, u=u, residual=residual, jacobian=jacobian,
                      information=information)  # fmt: skip
        state = replace(base_state, coordinates=coordinates, gls=gls)
        sds.append(np.sqrt(np.diagonal(free_values(state).covariance))[-3:])
    beside, at_the_end = np.array(sds)
    assert (at_the_end > 0.0).all()
    np.testing.assert_allclose(at_the_end, beside, rtol=0.25)


def _declared(low: float, high: float) -> ParamSpec:
    return ParamSpec("p", "", "-", low, high, "linear", 1.0)


def test_what_lies_in_a_range_leaves_nothing_beside_it_more_open_than_it_can():
    """As after a measurement of the middle of the range with its even distribution's variance."""
    spread = np.random.default_rng(2).standard_normal((3, 5)) * [[1.0], [40.0], [1e-3]]
    spread[0] += 0.02 * spread[1]
    declared = (_declared(0.0, np.inf), _declared(0.0, 20.0), _declared(-np.inf, np.inf))
    left = within_ranges(spread, declared)
    precision = np.linalg.inv(spread @ spread.T)
    precision[1, 1] += 12.0 / 20.0**2
    np.testing.assert_allclose(left @ left.T, np.linalg.inv(precision), rtol=1e-8)
    assert np.sqrt((left @ left.T)[1, 1]) < 20.0 / np.sqrt(12.0)


def test_what_the_data_know_far_better_than_its_range_stays_as_it_is():
    spread = np.random.default_rng(2).standard_normal((2, 2))
    left = within_ranges(spread, (_declared(0.0, 1e6), _declared(-1e6, 1e6)))
    np.testing.assert_allclose(left @ left.T, spread @ spread.T, rtol=1e-9)
    open_ = within_ranges(1e8 * spread, (_declared(0.0, 6.0), _declared(-np.inf, np.inf)))
    assert (open_ @ open_.T)[0, 0] == pytest.approx(3.0, rel=1e-6)


def test_a_sensible_covariance_is_that_of_the_data_where_they_tell(spring_state):
    """Of parameters that are known to a few per cent a wide expectation changes hardly anything."""
    known, sensible = free_values(spring_state).covariance, sensible_covariance(spring_state)
    told = np.sqrt(np.diagonal(known)) < 0.2 * np.abs(free_values(spring_state).values)
    assert told[-1]
    assert told.sum() > 4
    np.testing.assert_allclose(np.diagonal(sensible)[told], np.diagonal(known)[told], rtol=0.05)


def test_a_sensible_covariance_keeps_what_is_known_beside_what_is_not(spring_state):
    """Two coordinates that act alike: their sum is known, and neither by itself, within reason."""
    information = spring_state.gls.information.copy()
    information[1], information[:, 1] = information[0], information[:, 0]
    information[1, 1] = information[0, 0]
    state = replace(spring_state, gls=replace(spring_state.gls, information=information))
    coordinates, u = state.coordinates, jnp.asarray(state.u)
    slopes = np.asarray(jax.jacfwd(lambda z: free_vector(coordinates, z))(u))
    back = np.linalg.inv(slopes)
    of_u = back @ sensible_covariance(state) @ back.T
    n = len(information)
    alike = np.eye(n)[0] + np.eye(n)[1]
    expected = np.linalg.inv(np.delete(np.delete(information, 1, 0), 1, 1))[0, 0]
    assert alike @ of_u @ alike == pytest.approx(expected, rel=0.05)
    assert of_u[0, 0] > 1e3 * expected
