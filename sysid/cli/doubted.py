"""What a card says against itself, told by every command that uses it."""

from pathlib import Path
from typing import TYPE_CHECKING

from sysid.cli.console import Talk

if TYPE_CHECKING:
    from sysid.cards.schema import Card


def told_of_doubts(talk: Talk, card: "Card", name: Path | str) -> tuple[str, ...]:
    """Warn that a card comes from a result that must not be trusted.

    Args:
        talk: Of the command.
        card: As read.
        name: Of its file.

    Returns:
        The same sentences, for the command's notes; empty where the card may be trusted.
    """
    from sysid.cards.doubts import doubts_of

    told = tuple(f"{name} says of itself: {sentence}" for sentence in doubts_of(card))
    for sentence in told:
        talk.warn(sentence)
    return told
