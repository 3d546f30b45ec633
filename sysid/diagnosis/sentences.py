"""The answer as an engineer would write it, built from the numbers of a diagnosis."""

import math
from collections.abc import Iterator
from typing import Final

import numpy as np

from sysid.diagnosis.at_frequencies import frequencies_told
from sysid.diagnosis.contenders import LEAST_GAIN
from sysid.diagnosis.odd_level import odd_level
from sysid.diagnosis.remaining_words import (
    anova_told,
    never_halved_told,
    proposal_told,
    stability_told,
    strange_told,
)
from sysid.diagnosis.result import Cause, Diagnosis, Gain, Grid
from sysid.diagnosis.statics import static_forces
from sysid.diagnosis.where import smooth, where_wrong
from sysid.diagnosis.words import (
    EFFECT_WORDS,
    FAMILY_WORDS,
    FORM_WORDS,
    MODEL_WORDS,
    amount,
    amounts,
    capital,
    condition_words,
    listed,
    part_interval,
    percent,
    plain,
    shown,
    size_words,
)
from sysid.effects.registry import effect_kind
from sysid.identification.at_odds import AtOdds
from sysid.parameters import specs

_PARITY_WORDS: Final = {
    "OD": "resists motion alike in both directions (as friction, viscous and yield forces do)",
    "OC": "returns its energy alike on both sides (as springs, masses and delays do)",
    "ED": "resists motion differently at the two ends (as friction that depends on position does)",
    "EC": "pushes one way (as offsets, asymmetry and gas do)",
}
_STATIC_WORDS: Final = {
    "force_offset": ("a static force", "gas preload or load-cell zero"),
    "gas_spring": ("a stiffness", "gas spring"),
}
_NO_SHARE: Final = 5e-4
"""Share of the error below which an effect removes none."""
_LIMITS_TOLD: Final = 4
_POWER: Final = 0.84
"""Standard errors beyond a limit from which four cases of five pass it."""


def sentences(diagnosis: Diagnosis) -> tuple[str, ...]:
    """The answer, most important first; every number has its unit."""
    return tuple(_told(diagnosis))


def _told(d: Diagnosis) -> Iterator[str]:
    if d.set_aside is not None:
        yield _set_aside(d.set_aside)
    if d.answer == "base_inadequate":
        yield from _inadequate(d)
    if d.causes:
        yield from _causes(d)
    elif d.answer == "nothing":
        yield from _nothing(d)
    elif d.answer == "unknown":
        headline = _headline(d, d.simulated_before, smooth(d.loops.force))
        yield f"{headline}. No effect of the catalogue explains it."
    if d.gain is not None:
        yield from _gain(d.gain, _what_was_added(d))
    several = sum(c.status == "class" for c in d.causes) > 1
    for cause in d.causes:
        yield from _not_excluded(cause, several)
    if d.unknown.present:
        yield from _remaining(d)
    held = static_forces(d)
    if held:
        words = [(*_STATIC_WORDS[id], amount(q)) for id, q in held]
        told = [f"{what} of {size} ({cause})" for what, cause, size in words]
        yield f"The base model itself holds {listed(told)}."
    names = [_effect(z.id) for z in d.invisible if z.id not in dict(held)]
    if names:
        yield (
            f"These tests cannot show, and so do not exclude, {listed(names, 'or')}: each needs a "
            "test of its own."
        )


def _set_aside(odd: AtOdds) -> str:
    """Which tests the answer is not about, and what they look like."""
    one = len(odd.tests) == 1
    told = (
        f"{listed(odd.ids)} {'does' if one else 'do'} not agree with the other {odd.others} tests "
        f"and {'is' if one else 'are'} set aside"
    )
    looks = [
        f"{'it' if one else test.id} looks as if {' or '.join(test.looks)}"
        for test in odd.tests
        if test.looks
    ]
    return f"{'; '.join([told, *looks])}. What follows is about the other {odd.others}."


def _causes(d: Diagnosis) -> Iterator[str]:
    for cause in d.causes:
        if cause.from_cycles:
            yield (
                "Within each test the force changes from cycle to cycle, with "
                f"{plain(cause.extra_error)} N RMS left in the mean over its cycles: "
                f"{_cause(cause)}."
            )
    others = [c for c in d.causes if not (c.from_cycles or c.in_base)]
    if others:
        headline = _headline(d, d.simulated_before, d.simulated_after)
        beside = "Beside that, " if any(c.from_cycles for c in d.causes) else ""
        headline = f"{beside}{headline[:1].lower()}{headline[1:]}" if beside else headline
        further = _further(d)
        if len(others) == 1:
            yield f"{headline}: {_cause(others[0])}{further and f', with {further}'}."
        else:
            yield f"{headline}. {len(others)} causes were found{further and f', and {further}'}."
    for cause in others if len(others) > 1 else ():
        adds = f"it adds {plain(cause.extra_error)} N RMS over all tests"
        if cause.share >= _NO_SHARE:
            removes = f" and removes {percent(cause.share)} of what all effects together remove"
        else:
            removes = ", for which other parts of the model stood in without it"
        yield f"{capital(_cause(cause))}; {adds}{removes}."
    for cause in d.causes:
        if cause.in_base:
            yield f"{cause.because}: {_cause(cause, sized=False)}."
            continue
        if cause.because:
            yield _sentence(cause.because)
        yield from frequencies_told(cause, d.loops)
        yield from stability_told(cause)
    yield from never_halved_told(d.causes)


def _further(d: Diagnosis) -> str:
    """Effects of the extended model that are in no cause: they have their part in its force."""
    asserted = {id for cause in d.causes for id in cause.members}
    count = sum(e.facts.id not in asserted for e in d.damper.effects)
    if not count:
        return ""
    return f"{count} further effect{'s that are' if count > 1 else ' that is'} not asserted"


def _headline(d: Diagnosis, simulated: Grid, truth: Grid) -> str:
    """Where a simulation is wrong, with what sign, and how that grows; no full stop."""
    loops, place = d.loops, where_wrong(d.loops, simulated, truth)
    k = place.test
    at = condition_words(
        float(loops.amplitude[k]), float(loops.frequency[k]), float(loops.current[k])
    )
    along = f" for {plain(1e3 * place.travel)} mm" if place.travel is not None else ""
    grows = f"; all else equal, the error in newtons {listed(place.growth)}" if place.growth else ""
    if place.relative:
        grows += f"; relative to the force it {listed(place.relative)}"
    size = f"{plain(place.peak)} N"
    wrong = f"wrong by up to {size}" if place.sense == "wrong" else f"up to {size} {place.sense}"
    return f"At {at} the model is {wrong}{along} {place.region}{grows}"


def _cause(cause: Cause, *, sized: bool = True) -> str:
    """Name of a cause, and its parameters unless these were told; no full stop."""
    sure = f" (confidence {percent(cause.confidence)})"
    if cause.status == "family":
        words = FAMILY_WORDS[cause.family]
        return (
            f"something of the kind {words!r}{sure}, which no single name of the catalogue fits "
            "surely enough"
        )
    told = amounts(_effect(cause.members[0]), cause.parameters) if sized else ""
    name = _effect(cause.members[0]) + _form(cause)
    if cause.status == "class":
        others = listed([_effect(m) for m in cause.members[1:]], "or")
        told = f", in that case with {told}," if told else ""
        return f"either {name}{told} or {others}, which these tests cannot tell apart{sure}"
    return f"{name}{f', {told}' if told else ''}{sure}"


def _not_excluded(cause: Cause, several: bool) -> Iterator[str]:
    if cause.status == "named":
        if cause.separating_test:
            yield f"To be sure of {_effect(cause.members[0])}: {_clause(cause.separating_test)}."
        return
    names = [_effect(m) for m in (cause.members[1:] if cause.status == "class" else cause.members)]
    if names:
        instead = f" instead of {_effect(cause.members[0])}" if several else ""
        if cause.status == "family":
            told = f"Nearest of the kind {FAMILY_WORDS[cause.family]!r}"
        else:
            told = f"Not excluded{instead}"
        yield f"{told}: {listed(names, 'and')}."
    if cause.separating_test:
        what = "tell more" if len(cause.members) == 1 else "tell them apart"
        yield f"This would {what}: {_clause(cause.separating_test)}."


def _what_was_added(d: Diagnosis) -> str:
    """The extended model may hold effects that are no causes: they have their part in the gain."""
    if not d.causes:
        return _proposed(d)
    told = sum(not c.in_base for c in d.causes)
    added = len(d.damper.effects) + sum(c.from_cycles for c in d.causes)
    if added > told:
        return "all effects of the extended model" if added > 1 else "an effect"
    return "it" if told == 1 else "them"


def _proposed(d: Diagnosis) -> str:
    """Effects of an extended model of which none is asserted."""
    return "the proposed effect" + ("s" if len(d.damper.effects) > 1 else "")


def _gain(gain: Gain, added: str) -> Iterator[str]:
    adding = f"Adding {added}"
    change = "lowers" if gain.after < gain.before else "does not lower"
    level = f"from {percent(gain.before)} to {percent(gain.after)} of the peak force"
    verb = f"{adding} {change} the held-out error" + (
        f" {level}" if change == "lowers" else f": it goes {level}"
    )
    said = f"{verb}; repeatability is {percent(gain.repeatability)}"
    if gain.after < gain.before and math.isfinite(gain.reducible_explained):
        said += f". That is {percent(gain.reducible_explained)}"
        ends = part_interval(gain.low, gain.high)
        said += f" ({ends})" if ends else ""
        said += " of the error that a better model could remove"
    yield f"{said}."
    if gain.extrapolation:
        cases = [
            f"{what}: {percent(b)} before, {percent(a)} after" for what, b, a in gain.extrapolation
        ]
        yield f"Error, of the peak force, beyond the tests that were fitted: {'; '.join(cases)}."


def _remaining(d: Diagnosis) -> Iterator[str]:
    """What has no name, by its signature: what the last model leaves, whatever was added to it."""
    u, truth = d.unknown, smooth(d.loops.force)
    share = percent(u.share_of_reducible)
    about = f"{share} of the energy of the error that a better model could remove"
    if d.causes:
        yield f"{_headline_remaining(d)}: {about} remains and has no name."
    elif d.damper.effects:
        rest = _headline_remaining(d)
        rest = f"{rest[:1].lower()}{rest[1:]}: {about} remains and has no name"
        yield f"Beside {_proposed(d)}, {rest}."
    else:
        yield f"What has no name is {about}."
    if u.parity:
        kind, most = max(u.parity.items(), key=lambda item: item[1])
        yield f"{percent(most)} of the energy of what remains {_PARITY_WORDS[kind]}."
    grows = [f"{name}^{p:.1f}" for name, p in u.exponents.items() if math.isfinite(p)]
    if grows:
        yield f"Over all tests alike, large error or small, its RMS goes as {' · '.join(grows)}."
    odd = odd_level(d.loops, d.simulated_after, truth)
    if odd is not None:
        yield odd.words
    if u.depends_on:
        yield f"It varies with {listed(u.depends_on)}."
    if u.moves is not None:
        yield f"The base model could follow it only if its {u.moves} changed from test to test."
    yield from (_sentence(z) for z in u.because)
    yield from strange_told(u)
    if u.anova is not None:
        yield from anova_told(u.anova)
    if u.proposal:
        yield proposal_told(u.proposal)


def _headline_remaining(d: Diagnosis) -> str:
    said = _headline(d, d.simulated_after, smooth(d.loops.force))
    model = "the extended model" if d.damper.effects else "the model"
    return said.replace("the model is", f"{model} is still", 1)


def _nothing(d: Diagnosis) -> Iterator[str]:
    error, repeatability = d.base.held_out_nrmse, _repeatability(d)
    model = f"the {_model(d.base.model)} ({d.base.variant})"
    yield (
        f"These tests do not contradict {model} within {percent(error)} of the peak force, its "
        f"error on tests that it has not seen; repeatability is {percent(repeatability)}."
    )
    seen = [row for row in d.screen if math.isfinite(row.se) and row.se > 0.0 and row.score > 0.0]
    limits = []
    for row in seen:
        facts = effect_kind(row.id).facts
        unit = next(s.unit for s in specs(effect_kind(row.id)) if s.symbol == facts.size)
        if shown(facts.size, unit).inverse or len(limits) == _LIMITS_TOLD:
            continue
        limit = (math.sqrt(max(row.threshold, 2.0 * LEAST_GAIN)) + _POWER) * row.se
        limits.append(f"{_effect(row.id)} from {size_words(facts.size, unit, limit)}")
    if limits:
        yield (f"They would have shown, in four cases of five, for example {listed(limits, 'or')}.")


def _inadequate(d: Diagnosis) -> Iterator[str]:
    tried = [
        f"{percent(r.held_out_nrmse)} of the peak force ({_model(r.model)}, {r.variant}"
        + (f"; {percent(r.extended_nrmse)} with effects" if math.isfinite(r.extended_nrmse) else "")
        + ")"
        for r in sorted(d.rivals or (d.base,), key=lambda r: r.held_out_nrmse)
    ]
    yield (
        f"No base model describes this damper; errors on tests that they have not seen: "
        f"{listed(tried)}. Repeatability is {percent(_repeatability(d))}."
    )
    yield "No cause is named: any effect would only stand in for what the base model lacks."
    headline = _headline(d, d.simulated_before, smooth(d.loops.force))
    yield f"{headline} ({_model(d.base.model)}, {d.base.variant})."


def _repeatability(d: Diagnosis) -> float:
    """Mean over tests of the cycle-to-cycle scatter over max|F|; NaN with single cycles."""
    if d.gain is not None:
        return d.gain.repeatability
    scatter = d.loops.noise_floor / np.abs(d.loops.force).max(axis=1)
    known = scatter[np.isfinite(scatter)]
    return float(known.mean()) if known.size else math.nan


def _form(cause: Cause) -> str:
    """Which of its forms an effect was found in; nothing where that says nothing more."""
    field, words = FORM_WORDS.get(cause.members[0], ("", {}))
    told = words.get(getattr(cause.effect, field, ""), "")
    return f", {told}" if told else ""


def _effect(id: str) -> str:
    return EFFECT_WORDS.get(id, id)


def _model(name: str) -> str:
    return MODEL_WORDS.get(name, name)


def _sentence(text: str) -> str:
    return capital(text.strip().removesuffix(".")) + "."


def _clause(text: str) -> str:
    """To follow a colon."""
    text = text.strip().removesuffix(".")
    return text[:1].lower() + text[1:]
