"""Proof that a card computes here what it computed where it was made."""

import numpy as np

from sysid.cards.check import recompute
from sysid.cards.models import damper_of
from sysid.cards.schema import Card
from sysid.errors import CardError
from sysid.models.damper import Damper


def verify(card: Card, *, where: str = "card") -> Damper:
    """Hold the parameters against the models' bounds and recompute every check vector.

    Args:
        card: The card.
        where: Its file, for errors.

    Returns:
        The damper that the card describes, its effects included.

    Raises:
        CardError: An effect or a parameter is not what this program knows, or a force disagrees
            by more than the tolerance relative to max|force|.
    """
    damper = damper_of(card, where=where)
    for index, check in enumerate(card.check):
        expected, force = np.array(check.force), recompute(damper, check)
        scale = float(np.abs(expected).max())
        error = np.abs(force - expected)
        worst = int(np.argmax(np.where(np.isfinite(error), error, np.inf)))
        if not error[worst] <= check.tolerance * scale:
            raise CardError(
                f"does not reproduce its own check vector: {expected[worst]:.9g} N is written, "
                f"{force[worst]:.9g} N comes out (allowed {check.tolerance:g} of {scale:.6g} N)",
                where=f"{where}, check[{index}].force_N[{worst}]",
                advice="The card was altered by hand or damaged; write it again with `sysid fit`",
            )
    return damper
