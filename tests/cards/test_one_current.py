"""A damper tested at one current is known at that one, however its meter scatters."""

import csv

import numpy as np
import pytest

from sysid.cards.check import check_vectors
from sysid.cards.export.tables import table_csv, table_of
from sysid.cards.models import damper_of
from sysid.cards.outside import outside
from sysid.errors import CardError
from sysid.isolator.from_card import damper_of_card
from tests.cards.example import example_card

BOXES = {"driven": (0.199989, 0.200010), "off": (-2e-6, 8e-6)}


@pytest.fixture(params=BOXES)
def card(request):
    validity = example_card().validity.model_copy(update={"current": BOXES[request.param]})
    return example_card().model_copy(update={"validity": validity, "check": ()})


def test_an_isolator_refuses_it(card):
    with pytest.raises(CardError, match="one current cannot be controlled"):
        damper_of_card(card)


def test_it_is_tabled_at_one_current(card):
    table = table_of(card, damper_of(card))
    rows = [r for r in table_csv(table, card).splitlines() if not r.startswith("#")]
    (current,) = {float(r["current_A"]) for r in csv.DictReader(rows)}
    assert current == pytest.approx(0.2 if card.validity.current[1] > 0.1 else 0.0, abs=1e-6)


def test_its_check_vectors_have_one_loop_and_one_current(card):
    made = check_vectors(damper_of(card), card.validity)
    assert len(made) == 2
    assert {i for check in made for i in check.current} == {np.mean(card.validity.current)}


def test_what_the_meter_shows_is_inside(card):
    low, high = card.validity.current

    def told(current: float) -> tuple[str, ...]:
        return outside(card.validity, velocity=0.1, current=(current, current))

    assert told(low - 9e-4) == told(high + 9e-4) == ()
    assert "current" in told(high + 0.01)[0]
    assert "current" in told(low - 0.01)[0]
