"""The answer ladder: what may be asserted about each effect that was added, and how surely."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from sysid.diagnosis.absorbed import likeness
from sysid.diagnosis.contenders import LIKE_LAWS, Contender, Round
from sysid.diagnosis.decoys import STRANGE
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.remainder import remainder
from sysid.diagnosis.result import Status
from sysid.diagnosis.state import State
from sysid.effects.base import AbstractEffect
from sysid.effects.force.presliding_friction import PreslidingFriction
from sysid.effects.registry import effect_kind
from sysid.likelihood.discrepancy import Sizes

APART: Final = 3.0
"""A rival is excluded when it is less likely by more than this many of its distances."""
AS_MUCH: Final = 0.5
"""Part of what the chosen effect gains below which a rival that is not worth adding is none."""
LEAST_EVIDENCE: Final = 4.0
"""And by at least this log-likelihood."""
ALIKE: Final = 0.8
"""cos² from which two signatures count as one unless the refit tells them clearly apart."""
CLEARLY: Final = 25.0
"""Log-likelihood that tells such a pair apart."""
ENOUGH: Final = 0.7
"""Share of the error that the effects must explain, errors of the laws not counted, for a name."""
HALF: Final = 0.5
"""Share from which at least the family is asserted."""
SHORT: Final = 0.05
"""Travel before a seal slides, in parts of the smallest amplitude, below which tests of the whole
loop do not tell a presliding spring from plain friction."""
STRONG: Final = 50.0
STANDS_IN: Final = 0.5
"""Where so strong evidence is left, log-likelihood and in parts of what the chosen effect gained,
the chosen one stands in for something that it is only similar to: only its family is asserted."""
PART: Final = 0.2
"""The same where a random signature (`decoys`) would gain `STRANGE` beside all effects, and so much
of what the strongest of them gained: its formula is never quite the damper's."""
NEARLY: Final = 0.9
"""Share of the error from which what random signatures still find does not matter."""
UNSURE: Final = 0.6
"""Confidence below which no name or class is asserted, but the family, if there is one."""
CAP: Final = 0.9
"""Highest confidence under one admissible base."""
HIGHEST: Final = 0.98


@dataclass(frozen=True)
class Verdict:
    """What is asserted of one effect.

    Attributes:
        status: Name, class or family; None where nothing is.
        members: Ids that remain possible, the best first.
        confidence: Probability that the truth is among them.
        stability: Share of halves of the conditions that come to one of them.
    """

    status: Status | None
    members: tuple[str, ...]
    confidence: float
    stability: float = float("nan")


@dataclass(frozen=True)
class Shares:
    """How much of the error was explained.

    Attributes:
        explained: Of all reducible energy.
        beside_laws: Of the energy that is not shaped like an error of the valve's laws.
        law_shaped: Share of the remainder that is.
    """

    explained: float
    beside_laws: float
    law_shaped: float


def shares(
    evidence: Evidence,
    before: State,
    after: State,
    sizes: Sizes,
    lawful: float | None = None,
    right: Callable[[], bool] = lambda: False,
) -> Shares:
    """What effects explain of what can be explained.

    An effect far smaller than the rig's errors lowers the error by nothing that could be seen.
    Where the laws are right and what is left may be chance, it explains all that there was: what
    speaks for it is its likelihood.

    Args:
        evidence: The campaign.
        before: The base model, fitted for free runs.
        after: The extended one.
        sizes: Of the rig's errors.
        lawful: Part of what is left that Σ takes for an error of the laws; the part that other
            parameters for every loop would explain, if Σ was not fitted.
        right: Whether the laws are right beside the effects; asked only where it matters.
    """
    first, last = (remainder(evidence, s, sizes) for s in (before, after))
    if last.may_be_chance and right():
        return Shares(explained=1.0, beside_laws=1.0, law_shaped=last.law_shaped)
    removed = max(first.total - last.total, 0.0)
    left = last.reducible
    other = (1.0 - (last.law_shaped if lawful is None else lawful)) * left
    return Shares(
        explained=removed / max(removed + left, 1e-300),
        beside_laws=removed / max(removed + other, 1e-300),
        law_shaped=last.law_shaped,
    )


def rivals_of(one: Round, chosen: Contender, kept: tuple[str, ...] = ()) -> tuple[Contender, ...]:
    """Contenders of a round that cannot be told apart from the one that was chosen.

    Args:
        one: The round.
        chosen: Contender of it.
        kept: Effects of the final model: they are needed beside the chosen one, not instead of it.
    """
    found = []
    for rival in one.contenders:
        if rival is chosen or rival.id in kept or _is_special_case(chosen, rival):
            continue
        behind = chosen.gain - rival.gain
        alike = likeness(
            chosen.scored.signature,
            rival.scored.signature,
            one.before.gls.jacobian,
            one.before.covariance,
        )
        if (
            behind < LEAST_EVIDENCE
            or (behind < APART * rival.apart and rival.gain > _other(chosen, rival))
            or (behind < CLEARLY and alike > ALIKE)
        ):
            found.append(rival)
    return tuple(found)


def _other(chosen: Contender, rival: Contender) -> float:
    """Log-likelihood that a rival must gain to be another explanation rather than none."""
    return min(rival.least, AS_MUCH * chosen.gain)


def _is_special_case(chosen: Contender, rival: Contender) -> bool:
    """The rival has more parameters and, fitted, is the chosen one."""
    return rival.state.u.size > chosen.state.u.size and rival.apart < 2.0


def limits_of(effect: AbstractEffect, smallest: float) -> tuple[str, ...]:
    """Ids of simpler effects that this one, as identified, can hardly be told from.

    Args:
        effect: As identified.
        smallest: m, smallest amplitude of the campaign.
    """
    if isinstance(effect, PreslidingFriction):
        travel = float(effect.F_ps) / max(float(effect.sigma_0), 1e-300)
        return ("seal_friction",) if travel < SHORT * smallest else ()
    return ()


def outside(strange: float, gains: Sequence[float], explained: float = 0.0) -> bool:
    """Something acts that the catalogue lacks, and effects that were found may stand in for it.

    Args:
        strange: Log-likelihood that a random signature would gain beside all effects (`decoys`).
        gains: That each of the effects gained.
        explained: Share of all reducible energy that they explain: what is left beside nearly all
            of it is no cause, however surely it is there.
    """
    return explained < NEARLY and strange > max(STRANGE, PART * max(gains, default=0.0))


def verdict(
    one: Round,
    share: Shares,
    confirmed: bool,
    limits: tuple[str, ...] = (),
    leftover: float = 0.0,
    kept: tuple[str, ...] = (),
    strange: bool = False,
) -> Verdict:
    """What may be said of the effect that a round added.

    Args:
        one: The round.
        share: What all effects together explain.
        confirmed: The same effect won on another admissible base.
        limits: Effects that such tests cannot tell from it (`limits_of`, `like_speed`).
        leftover: Log-likelihood that a further effect would still gain, which was not added.
        kept: Effects of the final model.
        strange: The effect may stand in for something that the catalogue lacks (`outside`), or half
            of the tests come to another (`stability`).
    """
    chosen = one.contenders[0]
    rivals = rivals_of(one, chosen, kept)
    members = tuple(dict.fromkeys((chosen.id, *(r.id for r in rivals), *limits)))
    families = {effect_kind(m).facts.family for m in members}
    excluded = [
        c.gain
        for c in one.contenders
        if c is not chosen
        and c not in rivals
        and not _is_special_case(chosen, c)
        # by held-out error it came later, and is in the model beside the chosen one
        and not (c.id in kept and c.gain > chosen.gain)
    ]
    ahead = chosen.gain - max([0.0, *excluded])  # a rival worse than nothing proves nothing
    certainty = 1.0 - float(np.exp(-0.25 * ahead))
    top = HIGHEST if confirmed else CAP
    part = (
        share.explained if effect_kind(chosen.id).facts.family in LIKE_LAWS else share.beside_laws
    )
    stands_in = leftover > max(STRONG, STANDS_IN * chosen.gain)
    if stands_in or strange:
        part = min(part, 0.5 * (HALF + ENOUGH))
    if part < HALF:
        return Verdict(None, members, 0.0)
    grade = 0.8 + 0.2 * min((part - ENOUGH) / 0.2, 1.0)
    whole = 0.85 + 0.15 * min(share.explained / ENOUGH, 1.0)
    confidence = top * certainty * grade * whole
    if part >= ENOUGH and confidence >= UNSURE:
        return Verdict("class" if len(members) > 1 else "named", members, round(confidence, 3))
    if len(families) == 1:
        grade = min((part - HALF) / (ENOUGH - HALF), 1.0)
        return Verdict("family", members, round(0.5 + 0.3 * grade * certainty, 3))
    return Verdict(None, members, 0.0)
