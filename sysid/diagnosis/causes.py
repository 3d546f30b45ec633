"""From verdicts to the causes of a diagnosis, with their evidence."""

import jax.numpy as jnp
import numpy as np

from sysid.data.loops import Loops
from sysid.diagnosis.contenders import Round
from sysid.diagnosis.extension import Extended
from sysid.diagnosis.judged import round_of
from sysid.diagnosis.ladder import Verdict
from sysid.diagnosis.one_sided import FRICTION, OFFSET, TEST, one_sided
from sysid.diagnosis.plain import NONE
from sysid.diagnosis.quantities import Values, added_force, effect_quantities
from sysid.diagnosis.result import Cause, strongest_first
from sysid.diagnosis.tied import OF_FREQUENCY, OF_SPEED, frequency_is_tied, untying_words
from sysid.diagnosis.warmth import APART_FROM_DRIFT, LIKE_DRIFT
from sysid.diagnosis.words import EFFECT_WORDS, MODEL_WORDS, amounts, capital, count, plain
from sysid.effects.registry import effect_kind
from sysid.models.coordinates import valve_at


def causes_of(best: Extended, values: Values) -> tuple[Cause, ...]:
    """What is asserted, the surest kind first, the largest share first.

    Args:
        best: The extended base with its verdicts.
        values: Of its free parameters.
    """
    final, evidence = best.selection.final, best.base.evidence
    loops = evidence.loops
    damper = valve_at(final.coordinates, jnp.asarray(final.u))
    quantities = effect_quantities(final, values)
    energies = [evidence.energy(r.before.gls.residual) for r in best.selection.rounds]
    energies.append(evidence.energy(final.gls.residual))
    total = abs(energies[0] - energies[len(best.selection.rounds) - 1])
    causes = []
    for k, (kind, one) in enumerate(zip(best.selection.kept, best.verdicts, strict=True)):
        if one.status is None:
            continue
        number = best.selection.rounds.index(round_of(best.selection, kind))
        round_ = best.selection.rounds[number]
        chosen = round_.contenders[0]
        removed = energies[number] - energies[number + 1]
        causes.append(
            Cause(
                status=one.status,
                id=None if one.status == "family" else kind,
                members=one.members,
                family=effect_kind(kind).facts.family,
                effect=damper.effects[k],
                parameters=quantities[k],
                confidence=one.confidence,
                score=chosen.scored.score,
                share=float(np.clip(removed / max(total, 1e-300), 0.0, 1.0)),
                extra_error=added_force(evidence, final, k),
                because=_because(round_),
                separating_test=_separating(one, loops) if one.status != "named" else None,
                stability=one.stability,
            )
        )
    return strongest_first(causes)


def _because(round_: Round) -> str:
    """Evidence for the effect of a round, one sentence."""
    chosen, *rest = round_.contenders
    score, threshold = chosen.scored.score, chosen.scored.threshold
    about = _words(chosen.id)
    raises = f"raises the log-likelihood by {count(chosen.gain)}"
    if round_.before.sizes == NONE:  # without Σ a score is no χ², whatever its size
        told = f"{about}: fitted by least squares it {raises}"
    elif score > threshold:
        chance = f"where {threshold:.0f} would be chance"
        told = f"{about}: score {count(score)} {chance}; fitted it {raises}"
    else:
        told = f"{about} shows only when it is fitted, not in the linear score: it {raises}"
    if not rest:
        return (
            f"{told}; of the other effects of the catalogue that these tests could show none is "
            "left as a rival."
        )
    rival, gain = _words(rest[0].id), count(max(rest[0].gain, 0.0))
    if rest[0].gain > chosen.gain:  # far from any model, tests that were left out decide
        return f"{told}; {rival} by {gain}, with which tests left out are predicted less well."
    return f"{told}, the next best ({rival}) by {gain}."


def _words(id: str) -> str:
    return EFFECT_WORDS.get(id, id)


def _separating(one: Verdict, loops: Loops) -> str:
    members = set(one.members)
    if OFFSET in members and one.members[0] in FRICTION:
        return TEST
    if members & set(OF_FREQUENCY) and members & set(OF_SPEED) and frequency_is_tied(loops):
        return f"Frequency is tied to speed in these tests; add {untying_words(loops)}"
    if one.members[0] == "run_drift" and members & set(LIKE_DRIFT):
        return APART_FROM_DRIFT
    test = effect_kind(one.members[0]).facts.separating_test
    return capital(test)


def unnamed(best: Extended, values: Values) -> tuple[str, ...]:
    """What the extended model has beside its causes, for which nothing else speaks.

    Effects that are told of elsewhere are left out: refuted ones, and an offset that friction in
    one direction explains.

    Args:
        best: The extended base with its verdicts.
        values: Of its free parameters.
    """
    final, evidence = best.selection.final, best.base.evidence
    quantities = effect_quantities(final, values)
    elsewhere = {one.id for one in best.refuted}
    if one_sided(final) is not None:
        elsewhere.add(OFFSET)
    told = [
        f"{_words(kind)}, {amounts(_words(kind), quantities[k])}, which adds "
        f"{plain(added_force(evidence, final, k))} N RMS over all tests"
        for k, (kind, one) in enumerate(zip(best.selection.kept, best.verdicts, strict=True))
        if one.status is None and kind not in elsewhere
    ]
    if not told:
        return ()
    return (
        f"Beside its causes the extended model has {'; and '.join(told)}. That lowers its error, "
        "but what it stands for these tests do not tell.",
    )


def proposal_of(best: Extended, values: Values) -> str:
    """Effects that help although no base is adequate: proposals, never names."""
    assert best.gain is not None
    told = "; ".join(
        f"{_words(kind)}, {amounts(_words(kind), quantities)}"
        for kind, quantities in zip(
            best.selection.kept, effect_quantities(best.selection.final, values), strict=True
        )
    )
    model = best.base.fit.model
    return (
        f"Proposed, not named: {told}. With them the {MODEL_WORDS.get(model, model)} errs by "
        f"{100 * best.gain.after:.2g} % instead of {100 * best.gain.before:.2g} % of the peak "
        "force on conditions that it has not seen."
    )
