"""Verdicts on the effects of an extended base: confirmed by unseen tests, then by the ladder.

A name or class must be what halves of the tests come to as well; if they come to its family alone,
that is asserted, and else nothing.  With too few conditions for halves, each of several effects
must be confirmed beside the others.  Nor is anything asserted of an effect whose size is another
one in other tests (`constancy`), or of what was added beside it and gained less than it leaves.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import jax.numpy as jnp
import numpy as np

from sysid.diagnosis.constancy import VariedSize, varied_size
from sysid.diagnosis.contenders import Round, laws_are_right
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.extension import Extended
from sysid.diagnosis.ladder import Verdict, limits_of, outside, verdict
from sysid.diagnosis.one_sided import OFFSET, OneSided, one_sided
from sysid.diagnosis.plain import NONE
from sysid.diagnosis.predictive import CONFIRMED, density_gains, renewed
from sysid.diagnosis.prototypes import size_of
from sysid.diagnosis.scores import allowed
from sysid.diagnosis.selection import Selection, unlike, without
from sysid.diagnosis.stability import STEADY, has_halves, stability
from sysid.diagnosis.state import State
from sysid.diagnosis.tied import frequency_is_tied, like_speed
from sysid.diagnosis.warmth import LIKE_DRIFT, drifts_like_warmth
from sysid.effects.base import AbstractEffect
from sysid.effects.registry import effect_kind
from sysid.models.coordinates import valve_at
from sysid.models.damper import Damper

SURE: Final = 1.2
"""Standard errors over conditions by which the held-out RMSE must fall: the evidence for an effect
is its likelihood.  Where n conditions speak alike they give √n, and a single one gives 1, whatever
it says: an effect of which no other condition knows is confirmed by none."""
CONTRADICTED: Final = -2.0
"""Standard errors from which the held-out RMSE speaks against the effects, where the laws may err:
where they are right Σ is known, and by least squares a tenth of the rig's errors has any size."""
RENEWED: Final = 2.0
"""Standard errors by which the predictive density of conditions that were left out must rise where
the RMSE says nothing: errors of the rig hide from it an effect that is a tenth as large."""


def with_verdicts(best: Extended, others: Sequence[Extended]) -> Extended:
    """Judge every effect that stayed.

    Args:
        best: The extended base that errs least.
        others: Other admissible bases, extended, which confirm a name or do not.
    """
    sure = best.gain is not None and _confirmed(best)
    verdicts = []
    final, kept = best.selection.final, best.selection.kept
    gains = [round_of(best.selection, kind).contenders[0].gain for kind in kept]
    strange = outside(best.strange, gains, best.share.explained)
    wrong = refuted(best, gains)
    doubtful = in_doubt(wrong, kept, gains) | unconfirmed_alone(best) | of_no_real_sign(final)
    for kind in kept:
        round_ = round_of(best.selection, kind)
        effect = _effect(final, kind)
        confirmed = any(_same_sign(e, kind, effect) for e in others)
        loops = best.base.evidence.loops
        limits = limits_of(effect, float(loops.amplitude.min()))
        if frequency_is_tied(loops):
            limits = (*limits, *like_speed(kind))
        if kind == "run_drift" and drifts_like_warmth(loops, best.base.evidence.history):
            limits = (*limits, *LIKE_DRIFT)
        leftover = _leftover(best.selection, kind)
        one = verdict(round_, best.share, confirmed, limits, leftover, kept, strange)
        if not best.coarse:
            weaker = verdict(round_, best.share, confirmed, limits, leftover, kept, True)
        else:
            weaker = one
        one = steadied(best.selection.evidence, round_, one, weaker, kept)
        asserted = sure and kind not in doubtful
        verdicts.append(one if asserted else replace(one, status=None, confidence=0.0))
    alike = one_sided(final)
    if alike is not None:
        verdicts = [_as_one(alike, k, v) for k, v in zip(kept, verdicts, strict=True)]
    return replace(best, verdicts=tuple(verdicts), refuted=wrong)


def refuted(best: Extended, gains: Sequence[float]) -> tuple[VariedSize, ...]:
    """Effects whose size differs from test to test as their formula does not say.

    Args:
        best: The extended base.
        gains: Log-likelihood that each of its effects gained.
    """
    final = best.selection.final
    if final.sizes == NONE:  # without Σ errors of the laws would count as well
        return ()
    varied = [varied_size(best.base.evidence, final, k) for k in range(len(final.ids))]
    return tuple(v for v, gain in zip(varied, gains, strict=True) if v.refutes(gain))


def in_doubt(
    wrong: Sequence[VariedSize], kept: Sequence[str], gains: Sequence[float]
) -> frozenset[str]:
    """Ids of refuted effects, and of those that may be no more than what these leave.

    Args:
        wrong: Refuted effects.
        kept: Ids of all.
        gains: Log-likelihood that each gained.
    """
    left = max((v.gained for v in wrong), default=0.0)
    weaker = {kind for kind, gain in zip(kept, gains, strict=True) if gain < left}
    return frozenset(v.id for v in wrong) | weaker


def unconfirmed_alone(best: Extended) -> frozenset[str]:
    """Ids of effects that conditions left out do not speak for, each beside all the others.

    Asked where there are too few conditions for halves: else the gain of one effect would confirm
    whatever was added beside it.  Where Σ was not fitted, each was added by tests left out.

    Args:
        best: The extended base.
    """
    selection = best.selection
    evidence, final = selection.evidence, selection.final
    if best.coarse or len(final.ids) < 2 or has_halves(evidence):
        return frozenset()
    found = []
    for place, kind in enumerate(final.ids):
        smaller = without(evidence, final, place)
        gained = final.likelihood - smaller.likelihood
        if float(density_gains(evidence, smaller, final).sum()) <= CONFIRMED * gained:
            found.append(kind)
    return frozenset(found)


def of_no_real_sign(final: State) -> frozenset[str]:
    """Ids of effects that came to a sign that no damper has once others were added."""
    return frozenset(k for k in final.ids if not allowed(e := _effect(final, k), size_of(e)))


def _effect(state: State, kind: str) -> AbstractEffect:
    damper = valve_at(state.coordinates, jnp.asarray(state.u))
    return damper.effects[state.ids.index(kind)]


def _same_sign(other: Extended, kind: str, effect: AbstractEffect) -> bool:
    """Another base came to the effect as well, and to its sign."""
    final = other.selection.final
    return kind in final.ids and size_of(_effect(final, kind)) * size_of(effect) > 0.0


def steadied(
    evidence: Evidence, one: Round, found: Verdict, weaker: Verdict, kept: Sequence[str] = ()
) -> Verdict:
    """A verdict with its stability, or what is left of it if halves of the tests do not agree.

    Args:
        evidence: The campaign.
        one: The round of the effect.
        found: The verdict on all tests.
        weaker: That takes its place where halves come to its name or class too rarely; nothing
            does where they do not come to its family either.  `found` if halves do not count.
        kept: Effects of the final model.
    """
    steady = stability(evidence, one, found.members, kept)
    if steady < STEADY and weaker is not found:
        found = weaker
        if stability(evidence, one, kin(one), kept) < STEADY:
            found = replace(found, status=None, confidence=0.0)
    return replace(found, stability=steady)


def kin(one: Round) -> tuple[str, ...]:
    """Ids of the contenders of a round that are of the family of the chosen one."""
    first, *rest = one.contenders
    family = first.scored.effect.facts.family
    return (first.id, *(c.id for c in rest if c.scored.effect.facts.family == family))


def _as_one(found: OneSided, kind: str, own: Verdict) -> Verdict:
    """Friction that may be one with an offset stands for both of them."""
    if kind == OFFSET:
        return replace(own, status=None, confidence=0.0)
    if kind == found.friction and own.status in ("named", "class"):
        return replace(own, status="class", members=(*own.members, OFFSET))
    return own


def _confirmed(one: Extended) -> bool:
    """Conditions that were left out speak for the effects."""
    in_free_run = standard_errors(one)
    if in_free_run > SURE or one.coarse:
        return in_free_run > SURE
    selection, evidence = one.selection, one.base.evidence
    gains = density_gains(evidence, selection.base, selection.final)
    gained = selection.final.likelihood - selection.base.likelihood
    told = float(gains.sum()) > CONFIRMED * gained
    if told and laws_are_right(selection.evidence, selection.final):
        return True
    return renewed(gains) > RENEWED and in_free_run >= CONTRADICTED


def _leftover(selection: Selection, kind: str) -> float:
    """Log-likelihood that this effect does not gain but might.

    That of the best effect which was not added; one of a family that the model has says something
    of the effect of that family alone.  And that of a second effect of its family in the model
    that looks like it: two formulas that are needed together are not the damper's own.
    """
    last = selection.rounds[-1]
    own = effect_kind(kind).facts.family
    gains = [
        round_of(selection, other).contenders[0].gain
        for other in selection.kept
        if other != kind
        and effect_kind(other).facts.family == own
        and not _apart(selection, kind, other)
    ]
    gains += [
        one.gain
        for one in last.contenders
        if one.id not in selection.kept
        and (
            one.scored.effect.facts.family == own
            or one.scored.effect.facts.family not in last.families
        )
    ]
    return max(gains, default=0.0)


def _apart(selection: Selection, one: str, other: str) -> bool:
    """Two effects of the model look like nothing of each other."""
    first, second = (round_of(selection, k) for k in selection.kept if k in (one, other))
    return unlike(second.contenders[0], first)


def round_of(selection: Selection, kind: str) -> Round:
    """The round in which an effect was added."""
    return next(r for r in selection.rounds if r.contenders and r.contenders[0].id == kind)


def standard_errors(one: Extended) -> float:
    """Held-out gain over its standard error over conditions.

    Conditions count by the force that the effects add there: an effect that acts in few of them
    is judged by those.
    """
    assert one.gain is not None
    evidence = one.base.evidence
    damper = valve_at(one.free.coordinates, jnp.asarray(one.free.u))
    with_, without = (evidence.simulated(d) for d in (damper, Damper(damper.valve, ())))
    acts = np.sqrt(np.mean((with_ - without) ** 2, axis=1)) / evidence.peak
    difference = acts * (one.gain.per_test_before - one.gain.per_test_after)
    numbers = evidence.condition
    sums = np.array([difference[numbers == c].sum() for c in np.unique(numbers)])
    return float(sums.sum() / max(np.sqrt(np.sum(sums**2)), 1e-300))
