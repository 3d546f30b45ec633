"""That a card comes from a result that must not be trusted: how it says so, and who reads it."""

from collections.abc import Iterable
from typing import Final

from sysid.cards.schema import Card

MARK: Final = "This result must not be trusted: "
"""How such a sentence begins."""


def doubts(distrust: Iterable[str]) -> tuple[str, ...]:
    """Why a result must not be trusted, as sentences for the card and all that is exported from it.

    Args:
        distrust: Reasons.
    """
    return tuple(f"{MARK}{reason}." for reason in distrust)


def doubts_of(card: Card) -> tuple[str, ...]:
    """Such sentences of a card; empty where it comes from a result that may be trusted."""
    return tuple(told for told in card.known_discrepancies if told.startswith(MARK))
