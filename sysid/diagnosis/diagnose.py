"""Entry point: what the simulation gets wrong, why, and what the remedy is worth."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final

import jax.numpy as jnp
import numpy as np

from sysid.data.loops import Loops
from sysid.diagnosis.bases import BASES, LAST_RESORT, Base, admissible, extendable, fit_bases
from sysid.diagnosis.coarse import COARSE, select_coarsely
from sysid.diagnosis.decoys import STRANGE, strangest
from sysid.diagnosis.discrepancy import Sizes
from sysid.diagnosis.evidence import gather
from sysid.diagnosis.held_out import extrapolate, gain_of, leave_conditions_out
from sysid.diagnosis.hidden import hidden
from sysid.diagnosis.ladder import Shares, Verdict, limits_of, outside, shares, verdict
from sysid.diagnosis.plain import plainly_fitted, unweighted
from sysid.diagnosis.predictive import log_densities, renewed
from sysid.diagnosis.quantities import Values, added_force, effect_quantities, free_values
from sysid.diagnosis.remainder import lawful, remainder
from sysid.diagnosis.result import Answer, Cause, Diagnosis, Gain, Rival, ScreenRow
from sysid.diagnosis.selection import Round, Selection, select
from sysid.diagnosis.sentences import sentences
from sysid.diagnosis.stability import STEADY, stability
from sysid.diagnosis.state import State, settle
from sysid.diagnosis.unexplained import unexplained
from sysid.diagnosis.words import amount
from sysid.effects.registry import effect_kind
from sysid.errors import DataError
from sysid.models.coordinates import valve_at
from sysid.models.damper import Damper
from sysid.models.simulate import simulate
from sysid.motion.history import with_history
from sysid.motion.motion import loop_motion

INADEQUATE: Final = 0.06
"""Held-out RMSE/max|F| of the median test above which a base with its effects is inadequate, unless
they explain most of what can be explained."""
EXPLAINED: Final = 0.8
FEWEST: Final = 6
"""Tests below which nothing can be held out and compared."""
SURE: Final = 1.0
"""Standard errors over conditions by which the held-out RMSE must fall: the evidence for an effect
is its likelihood, the free run must not contradict it."""
RENEWED: Final = 2.0
"""Standard errors by which the predictive density of conditions that were left out must rise where
the RMSE says nothing: errors of the rig hide from it an effect that is a tenth as large."""


@dataclass(frozen=True)
class Extended:
    """A base with the effects found on it.

    Attributes:
        base: The base.
        selection: What was added and why.
        free: The extended model, fitted for free runs.
        share: How much it explains.
        gain: On tests not seen; None where nothing was added.
        verdicts: Of each effect.
        strange: Log-likelihood that a force which no effect has would gain beside them.
    """

    base: Base
    selection: Selection
    free: State
    share: Shares
    gain: Gain | None
    verdicts: tuple[Verdict, ...]
    strange: float = 0.0

    @property
    def error(self) -> float:
        """Mean held-out error of base and effects together."""
        return self.base.error if self.gain is None else self.gain.after

    @property
    def typical(self) -> float:
        """Median over tests of that error.

        At the edge of the matrix, where laws extrapolate, a few tests can be far off although the
        model is right.
        """
        errors = self.base.held_out if self.gain is None else self.gain.per_test_after
        return float(np.median(errors))


def diagnose_loops(
    loops: Loops,
    *,
    models: Sequence[tuple[str, str | None]] | None = None,
    max_effects: int = 4,
    run_order: np.ndarray | None = None,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> Diagnosis:
    """Say what a base model gets wrong on measured loops, and why.

    Args:
        loops: L tests on an even number of phase points.
        models: (name, variant) of the bases to try; `BASES` if None.
        max_effects: Effects to add at most.
        run_order: [L] position of each test in the campaign, if known.
        seed: Of starts and bootstrap.
        progress: Called with a line now and then.

    Raises:
        DataError: Fewer than six tests.
        FitError: No base model can be fitted.
    """
    if len(loops.ids) < FEWEST:
        raise DataError(
            f"{len(loops.ids)} tests are too few for a diagnosis",
            advice=f"At least {FEWEST} are needed, of several amplitudes, frequencies and currents",
        )
    say = progress or _silent
    evidence = gather(loops, run_order)
    bases = fit_bases(loops, evidence, models or BASES, seed=seed, progress=say)
    coarse = bases[0].in_sample > COARSE
    if not models and coarse:
        more = fit_bases(loops, evidence, LAST_RESORT, seed=seed, progress=say)
        bases = tuple(sorted((*bases, *more), key=lambda b: b.error))
    extended = [_extend(base, max_effects, seed, say) for base in extendable(bases, coarse=coarse)]
    best = min(extended, key=lambda e: e.error)
    others = [e for e in extended if e is not best]
    best = _with_verdicts(best, others)
    return _report(best, bases, extended, run_order)


def _silent(_: str) -> None:
    """Nobody listens."""


def _extend(base: Base, most: int, seed: int, say: Callable[[str], None]) -> Extended:
    """Select effects on a base and measure what they are worth."""
    evidence = base.evidence
    say(f"{base.fit.model}: looking for effects")
    plain = unweighted(evidence)
    coarse = base.in_sample > COARSE
    if coarse:
        selection = select_coarsely(plain, base.free, most=most, progress=say)
        free = selection.final
    else:
        state = settle(evidence, base.free.coordinates, base.free.u)
        selection = select(evidence, state, most=most, progress=say)
        free = plainly_fitted(plain, selection.final.coordinates, selection.final.u)
    gain = None
    if selection.kept:
        after = leave_conditions_out(plain, free)
        gain = gain_of(evidence, base.held_out, after, seed=seed)
    law_errors = None if coarse else lawful(evidence, selection.final)
    share = shares(evidence, base.free, free, _rig(selection), law_errors)
    strange = strangest(evidence, selection.final, seed)
    return Extended(base, selection, free, share, gain, (), strange)


def _rig(selection: Selection) -> Sizes:
    """Errors of the rig as the extended model sees them."""
    return selection.final.sizes


def _with_verdicts(best: Extended, others: Sequence[Extended]) -> Extended:
    """Judge every effect that stayed."""
    sure = best.gain is not None and _confirmed(best)
    verdicts = []
    final, kept = best.selection.final, best.selection.kept
    gains = [_round_of(best.selection, kind).contenders[0].gain for kind in kept]
    strange = outside(best.strange, gains, best.share.explained)
    for kind in kept:
        round_ = _round_of(best.selection, kind)
        confirmed = any(kind in e.selection.kept for e in others)
        damper = valve_at(final.coordinates, jnp.asarray(final.u))
        effect = damper.effects[final.ids.index(kind)]
        limits = limits_of(effect, float(best.base.evidence.loops.amplitude.min()))
        leftover = _leftover(best.selection, kind)
        one = verdict(round_, best.share, confirmed, limits, leftover, kept, strange)
        steady = stability(best.base.evidence, round_, one.members)
        if steady < STEADY and best.base.in_sample <= COARSE:
            one = verdict(round_, best.share, confirmed, limits, leftover, kept, True)
        one = replace(one, stability=steady)
        verdicts.append(one if sure else replace(one, status=None, confidence=0.0))
    return replace(best, verdicts=tuple(verdicts))


def _confirmed(one: Extended) -> bool:
    """Conditions that were left out speak for the effects."""
    in_free_run = _standard_errors(one)
    if in_free_run > SURE or one.base.in_sample > COARSE:
        return in_free_run > SURE
    if in_free_run < -SURE:
        return False
    selection, evidence = one.selection, one.base.evidence
    before, after = (log_densities(evidence, s) for s in (selection.base, selection.final))
    return renewed(before, after) > RENEWED


def _leftover(selection: Selection, kind: str) -> float:
    """Log-likelihood that this effect does not gain but might.

    That of the best effect which was not added; one of a family that the model has says something
    of the effect of that family alone.  And that of a second effect of its family in the model:
    two formulas that are needed together are not the damper's own.
    """
    last = selection.rounds[-1]
    own = effect_kind(kind).facts.family
    gains = [
        _round_of(selection, other).contenders[0].gain
        for other in selection.kept
        if other != kind and effect_kind(other).facts.family == own
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


def _round_of(selection: Selection, kind: str) -> Round:
    return next(r for r in selection.rounds if r.contenders and r.contenders[0].id == kind)


def _standard_errors(one: Extended) -> float:
    """Held-out gain over its standard error over conditions.

    Conditions count by the force that the effects add there: an effect that acts in few of them
    is judged by those.
    """
    assert one.gain is not None
    evidence = one.base.evidence
    damper = valve_at(one.free.coordinates, jnp.asarray(one.free.u))
    with_, without = (
        np.asarray(simulate(d, evidence.motion))[: evidence.tests]
        for d in (damper, Damper(damper.valve, ()))
    )
    acts = np.sqrt(np.mean((with_ - without) ** 2, axis=1)) / evidence.peak
    difference = acts * (one.gain.per_test_before - one.gain.per_test_after)
    numbers = evidence.condition
    sums = np.array([difference[numbers == c].sum() for c in np.unique(numbers)])
    return float(sums.sum() / max(np.sqrt(np.sum(sums**2)), 1e-300))


def _report(
    best: Extended,
    bases: Sequence[Base],
    extended: Sequence[Extended],
    run_order: np.ndarray | None,
) -> Diagnosis:
    base, selection = best.base, best.selection
    evidence, loops = base.evidence, base.evidence.loops
    inadequate = best.typical > INADEQUATE and (
        best.gain is None or best.gain.reducible_explained < EXPLAINED
    )
    proposed = inadequate and best.gain is not None and _standard_errors(best) > SURE
    asserted = proposed or any(v.status for v in best.verdicts)
    final = selection.final if asserted else selection.base
    values = free_values(final)
    causes = _causes(best, values) if asserted and not inadequate else ()
    gain = best.gain if asserted else None
    if gain is not None:
        gain = replace(gain, extrapolation=extrapolate(unweighted(evidence), base.free, best.free))
    motion = loop_motion(loops)
    if run_order is not None:
        motion = with_history(motion, run_order=np.asarray(run_order, dtype=float))
    free = best.free if asserted else base.free
    before_damper, after_damper = (
        valve_at(z.coordinates, jnp.asarray(z.u)) for z in (base.free, free)
    )
    before, after = (np.asarray(simulate(d, motion)) for d in (before_damper, after_damper))
    energy = [remainder(evidence, s, _rig(selection)) for s in (base.free, free)]
    unknown = unexplained(evidence, free, energy[1], energy[0], loops.force - after)
    present = unknown.present or (not asserted and best.strange > STRANGE)
    unknown = replace(unknown, present=present, strange=best.strange)
    if proposed:
        unknown = replace(unknown, because=(*unknown.because, _proposal(best, values)))
    answer = _answer(causes, inadequate, unknown.present)
    by_model = {id(e.base): e for e in extended}
    admitted = {id(b) for b in admissible(bases)}
    rivals = tuple(
        Rival(
            model=b.fit.model,
            variant=b.fit.variant,
            held_out_nrmse=b.error,
            extended_nrmse=by_model[id(b)].error if id(b) in by_model else float("nan"),
            admissible=id(b) in admitted,
        )
        for b in bases
    )
    scores = selection.rounds[0].scores
    told = Diagnosis(
        answer=answer,
        causes=causes,
        invisible=hidden(evidence, scores),
        unknown=unknown,
        gain=gain,
        screen=tuple(
            ScreenRow(c.effect.facts.id, c.score, c.threshold, c.survival, c.expected, c.se)
            for c in scores
        ),
        base=next(r for r, b in zip(rivals, bases, strict=True) if b is base),
        rivals=rivals,
        fit=base.fit,
        base_damper=before_damper,
        damper=after_damper,
        symbols=values.symbols,
        values=values.values,
        covariance=values.covariance,
        loops=loops,
        simulated_before=before,
        simulated_after=after,
        notes=_notes(best),
    )
    return replace(told, sentences=sentences(told))


def _proposal(best: Extended, values: Values) -> str:
    """Effects that help although no base is adequate: proposals, never names."""
    assert best.gain is not None
    told = "; ".join(
        f"{kind} ({', '.join(amount(q) for q in quantities)})"
        for kind, quantities in zip(
            best.selection.kept, effect_quantities(best.selection.final, values), strict=True
        )
    )
    return (
        f"Proposed, not named: {told}. With them the {best.base.fit.model} model errs by "
        f"{100 * best.gain.after:.2g} % instead of {100 * best.gain.before:.2g} % of the peak "
        "force on conditions that it has not seen."
    )


def _answer(causes: tuple[Cause, ...], inadequate: bool, unknown: bool) -> Answer:
    if inadequate:
        return "base_inadequate"
    for status in ("named", "class", "family"):
        if any(c.status == status for c in causes):
            return status
    return "unknown" if unknown else "nothing"


def _causes(best: Extended, values: Values) -> tuple[Cause, ...]:
    final, evidence = best.selection.final, best.base.evidence
    damper = valve_at(final.coordinates, jnp.asarray(final.u))
    quantities = effect_quantities(final, values)
    energies = [evidence.energy(r.before.gls.residual) for r in best.selection.rounds]
    energies.append(evidence.energy(final.gls.residual))
    total = abs(energies[0] - energies[len(best.selection.kept)])
    causes = []
    for k, (kind, one) in enumerate(zip(best.selection.kept, best.verdicts, strict=True)):
        if one.status is None:
            continue
        number = best.selection.rounds.index(_round_of(best.selection, kind))
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
                separating_test=_separating(one) if one.status != "named" else None,
                stability=one.stability,
            )
        )
    order = {"named": 0, "class": 1, "family": 2}
    return tuple(sorted(causes, key=lambda c: (order[c.status], -c.share)))


def _because(round_: Round) -> str:
    """Evidence for the effect of a round, one sentence."""
    chosen, *rest = round_.contenders
    threshold = chosen.scored.threshold
    told = (
        f"Its score is {chosen.scored.score:.0f} where {threshold:.0f} would be chance, and fitted "
        f"it raises the log-likelihood by {chosen.gain:.0f}"
    )
    if rest:
        return f"{told}, the next best ({rest[0].id}) by {max(rest[0].gain, 0.0):.0f}."
    return f"{told}; no other effect passes the screen."


def _separating(one: Verdict) -> str:
    test = effect_kind(one.members[0]).facts.separating_test
    return test[:1].upper() + test[1:]


def _notes(best: Extended) -> tuple[str, ...]:
    sizes = best.selection.final.sizes
    return (
        "From test to test the force channel varies by "
        f"{100 * sizes.gain:.2g} % in gain, {sizes.offset:.2g} N in offset and "
        f"{1e3 * sizes.delay:.2g} ms in delay (estimated with the fit).",
    )
