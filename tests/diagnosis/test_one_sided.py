"""Friction in one direction, and an offset beside friction that is not as large."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.diagnosis.evidence import gather
from sysid.diagnosis.judged import _as_one
from sysid.diagnosis.ladder import Verdict
from sysid.diagnosis.one_sided import OneSided, log_odds, one_sided
from sysid.diagnosis.state import settle
from sysid.effects.registry import effect_kind, make
from sysid.models.coordinates import place_of, valve_at
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import make_trial
from tests.diagnosis.diagnosed import DESIGN


def fitted(base_state, planters, percents):
    """The damper of the shared fixtures with friction and an offset, fitted."""
    found = gather(make_trial(71, tuple(map(find_planter, planters)), percents, DESIGN).loops)
    seal = make(effect_kind("presliding_friction"))
    seal = eqx.tree_at(lambda e: (e.F_ps, e.sigma_0), seal, (jnp.array(8.0), jnp.array(2e6)))
    effects = (seal, make(effect_kind("force_offset")))
    extended = DamperCoordinates(base_state.coordinates.valve_coordinates, effects)
    damper = valve_at(base_state.coordinates, jnp.asarray(base_state.u))
    for effect in effects:
        damper = damper.with_effect(effect)
    place = np.array(place_of(extended, damper))
    place[: base_state.u.size] = base_state.u
    return settle(found, extended, place, base_state.covariance)


def test_a_lip_that_grips_one_way_is_one_cause(base_state):
    found = one_sided(fitted(base_state, ("one_sided_lip",), (2.0,)))
    assert found is not None
    assert found.friction == "presliding_friction"
    assert abs(found.offset) == pytest.approx(found.size, rel=0.2)
    assert "one direction only" in found.words


def test_a_preload_three_times_the_friction_is_a_cause_of_its_own(base_state):
    assert one_sided(fitted(base_state, ("stiff_seal", "gas_preload"), (1.0, 3.0))) is None


def test_without_both_there_is_nothing_to_compare(base_state, spring_state):
    assert one_sided(base_state) is None
    assert one_sided(spring_state) is None


def test_odds_of_equal_sizes_fall_with_how_far_they_are_apart():
    assert log_odds(12.0, 12.0, 0.4) == pytest.approx(np.log(60.0 / np.sqrt(2.0 * np.pi)))
    assert log_odds(-12.0, 12.0, 0.4) == log_odds(12.0, 12.0, 0.4)
    assert log_odds(13.6, 12.0, 0.4) < 0.0 < log_odds(12.8, 12.0, 0.4)


def test_sizes_that_are_hardly_known_are_equal_by_chance():
    assert log_odds(12.0, 12.0, 12.0) < 0.0
    assert log_odds(12.0, 0.0, 1.0) == -np.inf


def test_by_chance_two_causes_are_taken_for_one_as_rarely_as_the_odds_say():
    """Offsets anywhere, friction of 10 N: of those taken for one, odds are right on the average."""
    rng = np.random.default_rng(2)
    deviation = 0.5
    two = rng.uniform(-20.0, 20.0, 20_000) + deviation * rng.standard_normal(20_000)
    one = 10.0 + deviation * rng.standard_normal(20_000)
    wrong, right = (np.mean([log_odds(z, 10.0, deviation) > 0.0 for z in zs]) for zs in (two, one))
    assert right > 0.95
    assert wrong < 0.15
    too_sure = np.mean([log_odds(z, 10.0, deviation / 4.0) > 0.0 for z in one])
    too_vague = np.mean([log_odds(z, 10.0, 4.0 * deviation) > 0.0 for z in two])
    assert too_sure < 0.7
    assert too_vague > 2.0 * wrong


def test_the_friction_stands_for_both():
    found = OneSided("seal_friction", 12.0, 12.0, 3.0)
    seal = Verdict("named", ("seal_friction",), 0.9, 1.0)
    offset = Verdict("named", ("force_offset",), 0.9, 1.0)
    spring = Verdict("named", ("gas_spring",), 0.9, 1.0)
    assert _as_one(found, "force_offset", offset).status is None
    both = _as_one(found, "seal_friction", seal)
    assert (both.status, both.members) == ("class", ("seal_friction", "force_offset"))
    assert _as_one(found, "gas_spring", spring) is spring
