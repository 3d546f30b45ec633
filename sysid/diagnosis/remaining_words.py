"""How steady a cause is, what the remainder varies with, and what is proposed, in sentences."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations
from math import floor, isnan, log10
from typing import Final

from sysid.diagnosis.constancy import VariedSize
from sysid.diagnosis.decoys import STRANGE
from sysid.diagnosis.quantities import NORMAL
from sysid.diagnosis.result import Anova, Cause, Dependence, Term, Unknown
from sysid.diagnosis.stability import STEADY
from sysid.diagnosis.words import EFFECT_WORDS, listed, percent, plain, shown, size_words
from sysid.effects.registry import effect_kind
from sysid.parameters import specs

TOLD: Final = 0.05
"""Share from which a quantity is told."""
LITTLE: Final = 0.1
"""Less than this, explained on unseen conditions, is hardly anything."""
MISSED: Final = 0.3
"""Two quantities pass for each other if neither is missed by more than this part of what each
explains alone, or both together."""


def stability_told(cause: Cause) -> Iterator[str]:
    """That some of the tests alone speak for a cause, where they do."""
    if cause.stability < STEADY:
        names = listed([EFFECT_WORDS.get(m, m) for m in cause.members], "or")
        yield (
            f"Only {percent(cause.stability)} of random halves of the conditions come to {names}: "
            "it rests on some of the tests."
        )


def never_halved_told(causes: Iterable[Cause]) -> Iterator[str]:
    """That nobody could ask halves of the tests, where that is so."""
    if any(isnan(c.stability) and not c.in_base and not c.from_cycles for c in causes):
        yield (
            "So few amplitudes and frequencies cannot be halved, to see whether each half comes to "
            "the same."
        )


def strange_told(unknown: Unknown) -> Iterator[str]:
    """That something acts which the catalogue lacks."""
    if unknown.strange > STRANGE:
        yield (
            "Something acts that the catalogue lacks: random smooth forces of no effect's shape "
            "explain more of it than chance allows."
        )


def refuted_told(varied: VariedSize) -> str:
    """Why an effect that was found is not called a cause."""
    kind = effect_kind(varied.id)
    spec = next(s for s in specs(kind) if s.symbol == kind.facts.size)
    view = shown(spec.symbol, spec.unit)
    name = EFFECT_WORDS.get(varied.id, varied.id)
    if varied.quantity is None:
        return f"It looks like {name}, but not at one size in all tests, so that is not named."
    least, most = (size_words(spec.symbol, spec.unit, z) for z in (varied.at_least, varied.at_most))
    ends = [_at(varied.quantity, z) for z in (varied.least, varied.most)]
    return (
        f"It looks like {name} whose {view.name or spec.name} goes from {least} at {ends[0]} to "
        f"{most} at {ends[1]}; by its formula it is one number, so that is not named."
    )


def _at(quantity: str, value: float) -> str:
    """A value of amplitude, frequency or current."""
    if quantity == "amplitude":
        return f"{plain(1e3 * value)} mm"
    return f"{plain(value)} {'Hz' if quantity == 'frequency' else 'A'}"


def anova_told(found: Anova) -> Iterator[str]:
    """With what the remainder varies, and what these tests cannot tell apart."""
    if found.explained < LITTLE:
        yield (
            "It repeats itself in no function of position, velocity, acceleration, current or "
            f"frequency: on unseen conditions such functions explain {percent(found.explained)} "
            "of it."
        )
        return
    told = [q for q in found.quantities if q.share >= TOLD]
    names = [q.quantity for q in told]
    of = f"a function of {listed(names)}" if names else _of_no_one(found)
    shares = ", ".join(f"{q.quantity} {percent(q.share)}" for q in told)
    split = f" ({shares})" if len(told) > 1 else ""
    yield (
        f"On conditions that it was not fitted to, {percent(found.explained)} of it is {of}{split}."
    )
    for pair in found.pairs:
        if pair.first in names and pair.second in names and pair.share >= TOLD:
            yield (
                f"{pair.first.capitalize()} and {pair.second} act together: {percent(pair.share)} "
                "of it is no sum of a function of each."
            )
    for one, other in combinations(found.quantities, 2):
        if _confounded(one, other):
            yield (
                f"These tests hardly tell {one.quantity} from {other.quantity}: alone they explain "
                f"{percent(one.alone)} and {percent(other.alone)} of it, beside each other only "
                f"{percent(one.only)} and {percent(other.only)} more."
            )


def _of_no_one(found: Anova) -> str:
    """No quantity has a share to be told."""
    if found.constant >= TOLD:
        return "a constant force"
    return "a function of several quantities, of none more than of the others"


def _confounded(one: Dependence, other: Dependence) -> bool:
    return all(q.alone >= TOLD and q.only < MISSED * q.alone for q in (one, other))


def proposal_told(terms: Sequence[Term]) -> str:
    """What terms would remove, as a proposal."""
    told = []
    for k, term in enumerate(terms):
        half = NORMAL * term.sd
        value = f"{_fixed(term.coefficient, half)} ± {_fixed(half, half)} {term.unit}"
        name = "cd"[k]
        symbol = name if term.formula == "1" else f"{name}·{term.formula}"
        more = "" if k == 0 else "a further "
        told.append(
            f"adding {symbol} with {name} = {value} removes {more}{percent(term.removes)} "
            f"(± {percent(NORMAL * term.se)})"
        )
    where = "of what is left on conditions that were not used for choosing it"
    return f"Proposed, not named: {listed(told)} {where}."


def _fixed(value: float, error: float) -> str:
    """A number to two digits of its error, without an exponent where it can be read."""
    if not error > 0.0:
        return f"{value:.3g}"
    decimals = 1 - floor(log10(error))
    rounded = round(value, decimals)
    return f"{rounded:.{max(decimals, 0)}f}" if abs(decimals) < 7 else f"{rounded:.3g}"
