"""Dampers that a card's uncertainty allows."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.cards.models import damper_of, effect_prefixes
from sysid.cards.schema import Card, Parameter
from sysid.errors import CardError
from sysid.isolator.from_card import CardDamper, damper_of_card
from sysid.parameters import specs
from sysid.uncertainty.covariance import OPEN, magnitude_of
from sysid.uncertainty.posterior import Posterior
from sysid.uncertainty.posterior_file import read_posterior

_SOUND: Final = 0.5
"""Largest share of draws that may make no damper before they are refused."""


@dataclass(frozen=True)
class DrawnDampers:
    """Dampers drawn, and from what.

    Attributes:
        dampers: They.
        source: In words.
    """

    dampers: tuple[CardDamper, ...]
    source: str


def drawn_dampers(
    card: Card, count: int, seed: int, *, where: str = "card", open_from: float = OPEN
) -> DrawnDampers:
    """Draws of the posterior that a card names, where its file is beside it; else normal ones.

    Every free parameter is drawn, those of effects included.  A covariance is straight where the
    model is not: along directions that the tests leave open (`OPEN`, relative to the parameters'
    own sizes) it would lead to other dampers than those that fit, so there draws stay where the
    card is, which costs next to nothing of the force's own uncertainty.  A draw outside of what
    the model allows makes no damper and is drawn anew.

    Args:
        card: With a covariance.
        count: How many.
        seed: Of the draws.
        where: The card's file.
        open_from: Standard deviation, in parts of the parameters' own sizes, from which on a
            direction is open.

    Raises:
        CardError: It has neither a posterior nor a covariance, that is too wide to draw from, or
            the posterior's file beside it is that of another fit.
    """
    rng = np.random.default_rng(seed)
    symbols, moved, source = _draws(card, round(count / _SOUND), rng, where, open_from)
    found: list[CardDamper] = []
    for row in moved:
        try:
            found.append(damper_of_card(_with(card, symbols, row), where=where))
        except CardError:
            continue
        if len(found) == count:
            return DrawnDampers(tuple(found), source)
    raise CardError(
        "its covariance is so wide that most draws are no dampers",
        where=where,
        advice="Give --draws 0, or fit more tests",
    )


def can_be_drawn(card: Card) -> bool:
    """It says how well its parameters are known."""
    return bool(card.covariance.symbols)


def _draws(
    card: Card, count: int, rng: np.random.Generator, where: str, open_from: float
) -> tuple[tuple[str, ...], Float[np.ndarray, "draw n"], str]:
    """Symbols as in the card, their values, and where these come from."""
    beside = _beside(card, where)
    if beside is not None:
        drawn = read_posterior(beside)
        unlike = _unlike(card, drawn)
        if unlike:
            raise CardError(
                f"{beside.name} beside it holds draws of another fit: {unlike}",
                where=where,
                advice="Put the file there that `sysid fit` wrote together with this card, or take "
                "this one away: then the card's covariance is drawn from",
            )
        chosen = rng.choice(len(drawn.flat), count, replace=len(drawn.flat) < count)
        told = f"the posterior's draws, {beside.name}"
        if not drawn.trusted:
            told += ", which are not to be trusted: " + drawn.account
        return drawn.symbols, drawn.flat[chosen], told
    known, measures = {p.symbol: p.value for p in _parameters(card)}, _measures(card, where)
    symbols = tuple(s for s in card.covariance.symbols if s in known)
    if not symbols:
        raise CardError(
            "has no covariance, so nothing can be drawn from it",
            where=where,
            advice="Give --draws 0, or a card that `sysid fit` wrote",
        )
    chosen = [card.covariance.symbols.index(s) for s in symbols]
    middle, measure = (np.array([z[s] for s in symbols]) for z in (known, measures))
    relative = np.asarray(card.covariance.matrix)[np.ix_(chosen, chosen)] / np.outer(
        measure, measure
    )
    variances, directions = np.linalg.eigh(relative)
    closed = variances < open_from**2
    if not closed.any():
        raise CardError(
            "its covariance leaves every direction open, so nothing can be drawn from it",
            where=where,
            advice="Give --draws 0, or fit more tests",
        )
    root = measure[:, None] * directions[:, closed] * np.sqrt(np.maximum(variances[closed], 0.0))
    normal = rng.standard_normal((count, int(closed.sum())))
    told = "the card's covariance, as normal"
    if not closed.all():
        told += f"; {np.count_nonzero(~closed)} directions that the tests leave open are held"
    return symbols, middle + normal @ root.T, told


def _measures(card: Card, where: str) -> dict[str, float]:
    """What changes of parameters are measured by."""
    damper = damper_of(card, where=where)
    prefixes = effect_prefixes([effect.id for effect in card.effects])
    declared = {spec.symbol: spec for spec in specs(damper.valve)}
    for prefix, effect in zip(prefixes, damper.effects, strict=True):
        declared |= {f"{prefix}{spec.symbol}": spec for spec in specs(effect)}
    values = np.array([p.value for p in _parameters(card)])
    symbols = [p.symbol for p in _parameters(card)]
    measured = magnitude_of(values, [declared[s] for s in symbols])
    return dict(zip(symbols, measured.tolist(), strict=True))


def _beside(card: Card, where: str) -> Path | None:
    if card.posterior is None or card.posterior.file is None:
        return None
    path = Path(where).parent / card.posterior.file
    return path if path.is_file() else None


def _unlike(card: Card, drawn: Posterior) -> str:
    """In what a posterior is not the one that a card tells of; empty where it is that one.

    The file has every k-th step, so that medians agree up to chance only; the evidence of
    convergence is that of all steps in either, to the last digit.
    """
    assert card.posterior is not None
    told = card.posterior.parameters
    if (drawn.model, drawn.variant) != (card.model, card.variant):
        return f"of {drawn.model}, {drawn.variant}; the card is of {card.model}, {card.variant}"
    if drawn.symbols != tuple(p.symbol for p in told):
        return f"of {', '.join(drawn.symbols)}; the card's are {', '.join(p.symbol for p in told)}"
    medians, evidence = np.median(drawn.flat, axis=0), drawn.convergence
    for p, median, *found in zip(
        told, medians, evidence.rhat, evidence.bulk, evidence.tail, strict=True
    ):
        if abs(median - p.median) > p.sd:
            return f"{p.symbol} has the median {median:.4g}; the card says {p.median:.4g}"
        own = [np.nan if z is None else z for z in (p.rhat, p.ess_bulk, p.ess_tail)]
        known = np.where(np.isfinite(found), found, np.nan)
        if not np.allclose(own, known, rtol=1e-6, atol=0.0, equal_nan=True):
            return f"of {p.symbol}: R̂ and the effective number of draws are others than the card's"
    return ""


def _parameters(card: Card) -> list[Parameter]:
    return [*card.parameters, *(p for e in card.effects for p in e.parameters)]


def _leaders(card: Card, free: tuple[str, ...]) -> dict[str, str]:
    """Parameter → the free one that it is kept equal to, as a symmetric model's are.

    Such a one is known as well as its leader is, and has no place in the covariance.
    """
    known = _parameters(card)
    told = {(p.value, p.sd, p.unit): p.symbol for p in known if p.symbol in free}
    followers = (p for p in known if p.symbol not in free and p.sd is not None)
    pairs = ((p.symbol, told.get((p.value, p.sd, p.unit))) for p in followers)
    return {follower: leader for follower, leader in pairs if leader is not None}


def _with(card: Card, symbols: tuple[str, ...], row: Float[np.ndarray, " n"]) -> Card:
    """The card with other values, and without vectors that proved the old ones."""
    drawn = dict(zip(symbols, map(float, row), strict=True))
    drawn |= {f: drawn[leader] for f, leader in _leaders(card, symbols).items()}

    def moved(parameters: tuple[Parameter, ...]) -> tuple[Parameter, ...]:
        return tuple(
            p.model_copy(update={"value": drawn[p.symbol]}) if p.symbol in drawn else p
            for p in parameters
        )

    effects = tuple(e.model_copy(update={"parameters": moved(e.parameters)}) for e in card.effects)
    parameters = moved(card.parameters)
    return card.model_copy(update={"parameters": parameters, "effects": effects, "check": ()})
