"""Which cards an isolator can run, and the dampers that they are."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import jax.numpy as jnp
import numpy as np

from sysid.cards.schema import Card
from sysid.cards.verify import verify
from sysid.effects.force.gas_spring import GasSpring
from sysid.errors import CardError
from sysid.isolator.gas import Gas
from sysid.isolator.lumped_step import LumpedStep, lumped_step
from sysid.isolator.study import stacked
from sysid.models.lumped import Lumped
from sysid.parameters import as_dict, build

SUPPORTED: Final = ("lumped",)
"""Models of cards."""
_SOUND: Final = 0.5
"""Largest share of draws that may make no damper before they are refused."""


@dataclass(frozen=True)
class CardDamper:
    """A card as an isolator needs it.

    Attributes:
        valve: The lumped model.
        gas: Its gas spring.
        left_out: Effects of the card that have no say here, each with the reason.
    """

    valve: Lumped
    gas: Gas
    left_out: tuple[str, ...]


def damper_of_card(card: Card, *, where: str = "card") -> CardDamper:
    """The damper of a card, if an isolator can run it.

    Effects on the recorder's channel are no force on the mass and are left out; a gas spring is
    taken; all others are refused by name.

    Raises:
        CardError: Another model than the lumped one, one current only, or an effect that is not
            supported.
    """
    damper = verify(card, where=where)
    valve = damper.valve
    if not isinstance(valve, Lumped):
        raise CardError(
            f"an isolator cannot run model {card.model!r} yet",
            where=f"{where}, model",
            advice=f"Supported: {', '.join(SUPPORTED)}; fit one with `sysid fit --model lumped`",
        )
    if len(valve.currents) < 2:
        raise CardError(
            "a damper known at one current cannot be controlled",
            where=f"{where}, parameters",
            advice="Fit tests at two currents or more",
        )
    stiffness, left_out, refused = 0.0, [], []
    for effect in damper.effects:
        if isinstance(effect, GasSpring):
            stiffness += float(effect.k_g)
        elif effect.stage == "channel":
            left_out.append(f"{effect.facts.id} is the recorder's, no force on the mass")
        else:
            refused.append(effect.facts.id)
    if refused:
        raise CardError(
            f"an isolator cannot run effect {', '.join(map(repr, refused))} yet",
            where=f"{where}, effects",
            advice="Supported: gas_spring, and all of stage 'channel', which it leaves out; "
            "give the base card",
        )
    return CardDamper(valve, Gas(0.0, stiffness), tuple(left_out))


def at_temperatures(valve: Lumped, temperatures: Sequence[float]) -> LumpedStep:
    """The damper at some temperatures, °C, one module with them in front."""
    return stacked([lumped_step(valve, jnp.asarray(float(t))) for t in temperatures])


def drawn_valves(card: Card, valve: Lumped, count: int, seed: int) -> list[Lumped]:
    """Dampers that the card's covariance allows, normal draws about its values.

    Args:
        card: With a covariance.
        valve: Its model.
        count: How many.
        seed: Of the draws.

    Raises:
        CardError: It has no covariance, or it is too wide to draw from.
    """
    known = as_dict(valve)
    symbols = [s for s in card.covariance.symbols if s in known]
    if not symbols:
        raise CardError(
            "has no covariance, so nothing can be drawn from it",
            advice="Leave --draws out, or give a card that `sysid fit` wrote",
        )
    chosen = [card.covariance.symbols.index(s) for s in symbols]
    matrix = np.asarray(card.covariance.matrix)[np.ix_(chosen, chosen)]
    values, vectors = np.linalg.eigh(matrix)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    rng = np.random.default_rng(seed)
    found: list[Lumped] = []
    for _ in range(round(count / _SOUND)):
        moved = root @ rng.standard_normal(len(symbols))
        numbers = dict(known)
        for symbol, change in zip(symbols, moved, strict=True):
            numbers[symbol] = known[symbol] + float(change)
        if min(numbers[s] for s in ("C_pre", "m_l", "tau")) > 0.0:
            found.append(build(Lumped, numbers))
        if len(found) == count:
            return found
    raise CardError(
        "its covariance is so wide that most draws are no dampers",
        advice="Leave --draws out, or fit more tests",
    )
