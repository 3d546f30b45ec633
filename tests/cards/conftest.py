import json
from typing import Any

import pytest

from sysid.cards.schema import Card
from sysid.cards.write import card_text
from tests.cards.example import example_card


@pytest.fixture
def card() -> Card:
    return example_card()


@pytest.fixture
def raw() -> dict[str, Any]:
    """The same card as plain JSON objects, to be spoilt."""
    return json.loads(card_text(example_card()))
