"""What an isolator refuses, by name and with the reason; and that what it takes has no memory."""

from pathlib import Path

import numpy as np
import pytest

from sysid.cards.export.pieces import WITHOUT_SAY, remembers
from sysid.cards.models import MODELS
from sysid.cards.schema import Card
from sysid.effects.base import AbstractEffect
from sysid.effects.drive.coil_lag import CoilLag
from sysid.effects.registry import EFFECTS, choices
from sysid.errors import CardError
from sysid.isolator.from_card import FOLLOWED, SUPPORTED, damper_of_card, why_not
from sysid.models.damper import Damper
from tests.cards.example import effect_entry, example_card
from tests.cards.export.dampers import effect, valve
from tests.cards.export.program import COMPUTED, Program, needs_compiler
from tests.isolator.conftest import card_of

FORMS = [
    kind(**kind.facts.nominal, **choice)
    for kind in EFFECTS
    for choice in choices(kind)
    if kind.facts.id not in (*WITHOUT_SAY, "surface_temperature")
]
"""Every effect that a simulated motion shows, in every form."""
KEEP = [e for e in FORMS if remembers(e)]
TAKEN = [
    e
    for e in FORMS
    if e.stage != "channel" and not isinstance(e, (CoilLag, *FOLLOWED)) and not why_not(e)
]
"""What is evaluated at an instant, without a state."""


def past(way: float, turned: bool) -> np.ndarray:
    """To the same last sample in one direction, or just turned and by another current, [n, 6]."""
    rows = np.zeros((200, 6))
    rows[:, 0] = 1e-3 * np.arange(200)
    rows[:, 2] = -0.05 * way if turned else 0.05 * way
    rows[:, 1] = 0.004 - way * 2e-5 - rows[:, 2] * (rows[-2, 0] - rows[:, 0])
    rows[:, 4] = 0.1 if turned else 0.3
    rows[:, 5] = 45.0
    rows[-1, 1:5] = 0.004, 0.002 * way, -1.0, 0.25
    return rows


def last_forces(effects: tuple[AbstractEffect, ...], folder: Path) -> np.ndarray:
    """Force at the same instant after two different pasts, for each direction, [2, 2] N."""
    program, found = Program("tanh", Damper(valve("tanh"), effects), folder), []
    for way in (1.0, -1.0):
        for turned in (False, True):
            program.reset()
            force, codes = program.run(past(way, turned))
            assert set(codes.tolist()) <= {*COMPUTED}
            found.append(float(force[-1]))
    return np.reshape(found, (2, 2))


@needs_compiler
def test_what_an_isolator_takes_has_no_memory(tmp_path):
    assert len(TAKEN) > 15
    straight, turned = last_forces(tuple(TAKEN), tmp_path).T
    np.testing.assert_array_equal(straight, turned)


@needs_compiler
@pytest.mark.parametrize("kept", KEEP, ids=lambda e: type(e).__name__)
def test_what_is_said_to_remember_does(kept, tmp_path):
    straight, turned = last_forces((kept,), tmp_path).T
    assert np.abs(turned - straight).max() > 1e-6 * np.abs(straight).max()


def card_with(*effects: AbstractEffect) -> Card:
    return example_card().model_copy(
        update={"effects": tuple(map(effect_entry, effects)), "check": ()}
    )


def test_every_refused_effect_is_named_with_its_reason():
    refused = (effect("velocity_delay"), effect("backlash"), effect("bypass_leakage"))
    with pytest.raises(CardError) as told:
        damper_of_card(card_with(*refused, effect("seal_friction")))
    said = str(told.value)
    assert "'velocity_delay', 'backlash' (the force depends on what came before" in said
    assert "'bypass_leakage' (the valve moves otherwise than the piston" in said
    assert "seal_friction'" not in said


def test_all_models_of_cards_run():
    assert set(SUPPORTED) == set(MODELS)


def test_what_the_step_carries_is_what_remembers_and_is_taken():
    carried = [e for e in KEEP if not why_not(e) and e.stage != "channel"]
    assert {type(e) for e in carried} == set(FOLLOWED)


@pytest.mark.parametrize("model", ["dahl", "bouc_wen", "modified_bouc_wen"])
@pytest.mark.parametrize(
    "id", ["series_compliance", "backlash", "entrained_air", "bypass_leakage", "seating_leakage"]
)
def test_beside_models_that_remember_the_same_effects_are_refused(model, id):
    with pytest.raises(CardError, match=id):
        damper_of_card(card_of(model, effect(id)))
