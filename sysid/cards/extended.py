"""A card from a diagnosis: the base model with the effects that were found on it."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy.special import stdtrit

from sysid import __version__
from sysid.cards.build import (
    covariance_of,
    error_sentences,
    files_of,
    left_sentences,
    parameter_of,
    validity_box,
)
from sysid.cards.check import check_vectors
from sysid.cards.models import effect_prefixes
from sysid.cards.noise import mean_cycle_noise_nrmse, repeatability_nrmse
from sysid.cards.schema import SCHEMA, Card, Damper, Effect, Quality
from sysid.data.record import Record
from sysid.diagnosis.result import Diagnosis
from sysid.effects.base import AbstractEffect
from sysid.effects.registry import choice_of
from sysid.identification.conditions import conditions
from sysid.identification.fit import errors_of
from sysid.parameters import ParamSpec, as_dict, specs
from sysid.uncertainty.covariance import LEVEL, estimate_of, magnitude_of
from sysid.uncertainty.determined import undetermined
from sysid.uncertainty.estimate import Estimate


def card_of_diagnosis(
    diagnosis: Diagnosis,
    records: Iterable[Record],
    *,
    damper: str,
    campaign: str,
    remarks: Sequence[str] = (),
) -> Card:
    """The extended model as a card; the base model's where nothing was found.

    Args:
        diagnosis: With its damper fitted to all of its tests.
        records: The campaign's records, for the files' hashes.
        damper: Name of the damper.
        campaign: Name of the campaign.
        remarks: Further sentences for the known discrepancies.

    Returns:
        A card without any time of making: the same diagnosis gives the same bytes.
    """
    found, fit, loops = diagnosis.damper, diagnosis.fit, diagnosis.loops
    symbols = _as_in_cards(diagnosis.symbols)
    base, effects = _estimates(diagnosis, symbols)
    estimates = [*base, *(e for own in effects for e in own)]
    validity = validity_box(loops, (), ())
    tests = errors_of(loops, diagnosis.simulated_after)
    held_out = diagnosis.base.held_out_nrmse if diagnosis.gain is None else diagnosis.gain.after
    return Card(
        format=SCHEMA,
        software=f"sysid {__version__}",
        model=fit.model,
        variant=fit.variant,
        weights=fit.weights,
        damper=Damper(name=damper, campaign=campaign),
        parameters=tuple(parameter_of(e) for e in base),
        effects=tuple(_effect(e, own) for e, own in zip(found.effects, effects, strict=True)),
        covariance=covariance_of(symbols, diagnosis.covariance),
        posterior=None,
        interval=f"{LEVEL:g}, {diagnosis.interval}",
        validity=validity,
        quality=Quality(
            mean_nrmse=float(np.mean([t.nrmse for t in tests])),
            held_out_mean_nrmse=float(held_out) if np.isfinite(held_out) else None,
            noise_floor_nrmse=repeatability_nrmse(loops),
            mean_cycle_noise_nrmse=mean_cycle_noise_nrmse(loops),
        ),
        known_discrepancies=(
            *error_sentences(tests),
            *_open(diagnosis, symbols, estimates),
            *_doubts(diagnosis),
            *fit.notes,
            *left_sentences(t for t in fit.tests if t.id not in loops.ids),
            *remarks,
        ),
        data=files_of(records, set(loops.ids)),
        check=check_vectors(found, validity),
    )


def _as_in_cards(symbols: Sequence[str]) -> tuple[str, ...]:
    """Symbols of free parameters; those of a second form of an effect get another prefix."""
    named = []
    for place, symbol in enumerate(symbols):
        id, dot, own = symbol.partition(".")
        prefix = effect_prefixes([id] * (1 + list(symbols[:place]).count(symbol)))[-1]
        named.append(f"{prefix}{own}" if dot else symbol)
    return tuple(named)


def _estimates(
    diagnosis: Diagnosis, symbols: tuple[str, ...]
) -> tuple[list[Estimate], list[list[Estimate]]]:
    """Parameters of the model, and those of each effect."""
    loops, damper = diagnosis.loops, diagnosis.damper
    sd = dict(zip(symbols, np.sqrt(np.diagonal(diagnosis.covariance)).tolist(), strict=True))
    groups = int(conditions(loops).max()) + 1
    quantile = float(stdtrit(max(groups - 1, 1), 0.5 + LEVEL / 2))
    leader, value = dict(diagnosis.fit.coordinates.ties), as_dict(damper.valve)
    base = [
        estimate_of(
            s, value[s.symbol], sd.get(leader.get(s.symbol, s.symbol), 0.0), quantile,
        )
        for s in specs(damper.valve)
    ]  # fmt: skip
    prefixes = effect_prefixes([effect.facts.id for effect in damper.effects])
    effects = []
    for effect, prefix in zip(damper.effects, prefixes, strict=True):
        own = (
            estimate_of(
                s, float(getattr(effect, s.symbol)), sd.get(prefix + s.symbol, 0.0), quantile
            )
            for s in specs(effect)
        )
        effects.append([replace(e, symbol=prefix + e.symbol) for e in own])
    return base, effects


def _effect(effect: AbstractEffect, estimates: Sequence[Estimate]) -> Effect:
    return Effect(
        id=effect.facts.id,
        stage=effect.stage,
        choice=dict(choice_of(effect)),
        parameters=tuple(parameter_of(e) for e in estimates),
    )


def _open(
    diagnosis: Diagnosis, symbols: tuple[str, ...], estimates: Sequence[Estimate]
) -> tuple[str, ...]:
    """What the data leave open of the parameters."""
    declared = {e.symbol: s for e, s in zip(estimates, _declared(diagnosis), strict=True)}
    size = magnitude_of(diagnosis.values, [declared[symbol] for symbol in symbols])
    relative = diagnosis.covariance / np.outer(size, size)
    return undetermined(symbols, diagnosis.values, relative, estimates)


def _declared(diagnosis: Diagnosis) -> Iterator[ParamSpec]:
    damper = diagnosis.damper
    for part in (damper.valve, *damper.effects):
        yield from specs(part)


def _doubts(diagnosis: Diagnosis) -> Iterator[str]:
    """What is not sure about the effects, and what remains beside them."""
    for cause in diagnosis.causes:
        if cause.from_cycles:
            told = ", ".join(f"{q.symbol} = {q.value:.3g} {q.unit}" for q in cause.parameters)
            yield (
                f"{cause.effect.facts.id} ({told}) changes the force from cycle to cycle after a "
                "start; it was taken out of the tests, and this card does not have it."
            )
        if cause.in_base:
            held = " or ".join(cause.members)
            yield f"{cause.because}: {held}, in this card a part of its table."
            continue
        id, test = cause.effect.facts.id, cause.separating_test
        settle = f"; this would tell: {test}" if test else ""
        others = ", ".join(other for other in cause.members if other != id)
        if cause.status == "class" and others:
            yield f"{id} may as well be {others}: these tests do not tell them apart{settle}."
        elif cause.status == "family":
            yield f"{id} stands for the family {cause.family}: its cause is not known{settle}."
    yield from diagnosis.unknown.because
    if diagnosis.answer == "base_inadequate":
        yield "No base model describes these tests well enough to look for effects."
    if diagnosis.invisible:
        yield f"These tests cannot show: {', '.join(i.id for i in diagnosis.invisible)}."
    if diagnosis.gain is None and not np.isfinite(diagnosis.base.held_out_nrmse):
        yield "No test was held out: the errors are those of tests that were fitted."
