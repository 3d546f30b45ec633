"""What is left open, as dampers: each member of a class in all forms that the tests allow."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis.alternatives import _classes, _forms, _sought
from sysid.diagnosis.bases import Base
from sysid.diagnosis.contenders import Contender, Round
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.extension import Extended
from sysid.diagnosis.result import Cause
from sysid.diagnosis.scores import Scored
from sysid.diagnosis.selection import Selection
from sysid.diagnosis.state import State, settle
from sysid.effects.registry import choice_of, effect_kind, make
from sysid.models.damper_coordinates import DamperCoordinates
from tests.diagnosis.bare import bare


@pytest.fixture(scope="module")
def late(evidence, base_state) -> Extended:
    """The base with a delay, which is what a round had chosen."""
    delay = make(effect_kind("force_delay"))
    extended = DamperCoordinates(base_state.coordinates.valve_coordinates, (delay,))
    start = np.append(base_state.u, 0.1)
    final = settle(evidence, extended, start, base_state.covariance)
    contender = bare(Contender, scored=bare(Scored, effect=delay), state=final)
    return extended_by(evidence, final, bare(Round, contenders=(contender,), scores=()))


def extended_by(evidence: Evidence, final: State, *rounds: Round) -> Extended:
    selection = bare(Selection, final=final, rounds=rounds)
    return bare(Extended, base=bare(Base, evidence=evidence), selection=selection)


def test_a_filter_is_asked_about_with_one_pole_and_with_two(late):
    """The second passes for a delay; asked about the first alone, any test would seem to tell."""
    found = _forms(late, "force_delay", "force_filter")
    assert [choice_of(one.damper.effects[-1])["poles"] for one in found] == ["one", "two"]
    assert all(one.ids == ("force_filter",) for one in found)
    assert all(np.isfinite(one.covariance).all() for one in found)


def test_the_chosen_effect_is_as_it_was_fitted(late):
    (one,) = _forms(late, "force_delay", "force_delay")
    assert one.ids == ("force_delay",)
    assert float(one.damper.effects[-1].tau_F) != 0.0


def test_an_effect_that_the_model_has_is_not_put_in_twice(late):
    evidence, final = late.base.evidence, late.selection.final
    assert _forms(late, "force_delay", "gas_spring") != []
    coordinates = final.coordinates
    twice = (make(effect_kind("gas_spring")), *coordinates.prototypes)
    both = DamperCoordinates(coordinates.valve_coordinates, twice)
    beside = extended_by(evidence, bare(State, coordinates=both), *late.selection.rounds)
    assert _forms(beside, "force_delay", "gas_spring") == []


def test_of_a_class_with_a_member_that_was_not_sought_no_test_is_simulated(late):
    """At one temperature a law of it does nothing: beside the tests it would be no explanation."""
    selection = bare(Selection, final=late.selection.final, rounds=(), kept=("force_delay",))
    members = ("force_delay", "viscosity_temperature")
    cause = bare(Cause, members=members, effect=late.selection.final.coordinates.prototypes[0])
    evidence = late.base.evidence
    same = np.full(evidence.tests, 25.0)
    cold = replace(evidence, loops=replace(evidence.loops, temperature=same))
    known, unknown = (
        _sought(bare(Extended, base=bare(Base, evidence=z), selection=selection))
        for z in (evidence, cold)
    )
    assert set(members) <= known
    assert not set(members) <= unknown
    best = bare(Extended, base=bare(Base, evidence=cold), selection=selection)
    assert list(_classes(best, (cause,))) == []
