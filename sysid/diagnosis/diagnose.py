"""Entry point: what the simulation gets wrong, why, and what the remedy is worth."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

import jax.numpy as jnp
import numpy as np

from sysid.data.loops import Loops
from sysid.diagnosis.alternatives import left_open
from sysid.diagnosis.bases import (
    LAST_RESORT,
    Base,
    admissible,
    by_rank,
    extendable,
    fit_bases,
    outdone,
    usual_bases,
    with_error_models,
)
from sysid.diagnosis.causes import causes_of, proposal_of, unnamed
from sysid.diagnosis.coarse import COARSE
from sysid.diagnosis.compiled import make_room
from sysid.diagnosis.decoys import STRANGE
from sysid.diagnosis.evidence import held_together
from sysid.diagnosis.extension import Extended, extend
from sysid.diagnosis.far_off import far_off
from sysid.diagnosis.free_run_values import free_run_values
from sysid.diagnosis.held_out import extrapolate
from sysid.diagnosis.held_out_words import what_was_held_out
from sysid.diagnosis.hidden import hidden
from sysid.diagnosis.idle_yield import idle_yield
from sysid.diagnosis.judged import SURE, standard_errors, with_verdicts
from sysid.diagnosis.needed_sizes import needed_sizes
from sysid.diagnosis.one_sided import one_sided
from sysid.diagnosis.plain import NONE, unweighted
from sysid.diagnosis.quantities import free_values
from sysid.diagnosis.remainder import remainder
from sysid.diagnosis.remaining_words import refuted_told
from sysid.diagnosis.result import Answer, Cause, Diagnosis, Rival, ScreenRow, strongest_first
from sysid.diagnosis.scores import Scored
from sysid.diagnosis.sentences import sentences
from sysid.diagnosis.steady_state import Removed, take_out, told, whole_gain, with_removed
from sysid.diagnosis.unexplained import unexplained
from sysid.diagnosis.within_tests import Within
from sysid.errors import DataError
from sysid.identification.at_odds import AtOdds, at_odds
from sysid.models.coordinates import valve_at
from sysid.models.simulate import simulate
from sysid.motion.history import RunHistory, with_history
from sysid.motion.motion import loop_motion

INADEQUATE: Final = 0.06
"""Held-out RMSE/max|F| of the median test above which a base with its effects is inadequate, unless
they explain most of what can be explained."""
EXPLAINED: Final = 0.8
MOST: Final = 8
"""Effects that are added at most, unless told otherwise: so many that the search ends because no
further one pays.  The physical damper's matrix needs six, its sweep over temperature four."""
OF_A_RIG: Final = replace(NONE, gain=0.03, thermometer=5.0)
"""Errors that load cells and thermometers have at most; larger ones stand for something else."""
FEWEST: Final = 6
"""Tests below which nothing can be held out and compared."""


def diagnose_loops(
    loops: Loops,
    *,
    models: Sequence[tuple[str, str | None]] | None = None,
    max_effects: int = MOST,
    history: RunHistory | None = None,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> Diagnosis:
    """Say what a base model gets wrong on measured loops, and why.

    Tests that all others contradict (`at_odds`) are set aside, and the answer begins with them.

    Args:
        loops: L tests on an even number of phase points.
        models: (name, variant) of the bases to try; if None `usual_bases`, and further ones where
            none of these is adequate.
        max_effects: Effects to add at most.
        history: Of the L tests, if their order is known.
        seed: Of starts, decoys and halves.
        progress: Called with a line now and then.

    Raises:
        DataError: Fewer than six tests, or all of one condition.
        FitError: No base model can be fitted.
    """
    if len(loops.ids) < FEWEST:
        raise DataError(
            f"{len(loops.ids)} tests are too few for a diagnosis",
            advice=f"At least {FEWEST} are needed, of several amplitudes, frequencies and currents",
        )
    if not held_together(loops).any():
        raise DataError(
            f"all {len(loops.ids)} tests are of one amplitude, frequency and temperature, so that "
            "none can be predicted from others",
            advice="Add tests of another amplitude or frequency (`sysid fit` can do with these)",
        )
    say = progress or _silent
    make_room()
    given = models or usual_bases(loops)
    bases = _fit(loops, history, given, not models, seed, say)
    odd = next((o for b in admissible(bases) if (o := at_odds(b.fit, loops))), None)
    if odd is not None:
        say(f"set aside, for the others contradict it: {', '.join(odd.ids)}")
        kept = np.array([name not in odd.ids for name in loops.ids])
        loops, history = loops.select(kept), history and history.select(kept)
        bases = _fit(loops, history, given, not models, seed, say)
    within, removed = take_out(loops, history, bases, seed)
    if removed is not None:
        say(f"taken out of every cycle: {', '.join(w.members[0] for w in removed.found)}")
        bases = _fit(removed.loops, history, given, not models, seed, say)
    coarse = far_off(bases[0])
    if not coarse:
        bases = with_error_models(bases)
    extended: list[Extended] = []
    for base in extendable(bases, coarse=coarse):
        if outdone(base, min((e.error for e in extended), default=np.inf)):
            say(f"{base.fit.model}: errs more than another base with its effects; not extended")
        else:
            extended.append(extend(base, max_effects, seed, say, coarse=coarse))
    best = min(extended, key=lambda e: e.error)
    sound = {id(b) for b in admissible(bases)}
    others = [e for e in extended if e is not best and id(e.base) in sound]
    best = with_verdicts(best, others)
    return _report(best, bases, extended, history, within, removed, odd)


def _fit(
    loops: Loops,
    history: RunHistory | None,
    models: Sequence[tuple[str, str | None]],
    usual: bool,
    seed: int,
    say: Callable[[str], None],
) -> tuple[Base, ...]:
    """All bases, best first; further ones where the usual ones are far off."""
    bases = fit_bases(loops, models, history=history, seed=seed, progress=say)
    if usual and bases[0].in_sample > COARSE:
        more = fit_bases(loops, LAST_RESORT, history=history, seed=seed, progress=say)
        bases = by_rank((*bases, *more))
    return bases


def _silent(_: str) -> None:
    """Nobody listens."""


def _report(
    best: Extended,
    bases: Sequence[Base],
    extended: Sequence[Extended],
    history: RunHistory | None,
    within: Within,
    removed: Removed | None,
    odd: AtOdds | None,
) -> Diagnosis:
    make_room()
    base, selection = best.base, best.selection
    evidence, loops = base.evidence, base.evidence.loops
    raw = base if removed is None else removed.base_like(base)
    inadequate = best.typical > INADEQUATE and (
        best.gain is None or best.gain.reducible_explained < EXPLAINED
    )
    proposed = inadequate and best.gain is not None and standard_errors(best) > SURE
    asserted = proposed or any(v.status for v in best.verdicts)
    final = selection.final if asserted else selection.base
    values = free_values(final)
    causes = causes_of(best, values) if asserted and not inadequate else ()
    beside = unnamed(best, values) if causes else ()
    gain = best.gain if asserted else None
    if gain is not None:
        as_they_were = (unweighted(raw.evidence), raw.free)
        further = extrapolate(as_they_were, (unweighted(evidence), best.free))
        gain = replace(gain, extrapolation=further)
    if removed is not None and not inadequate:
        causes = with_removed(removed, best, causes)
        gain = whole_gain(removed, best, gain)
    idle = None if inadequate else idle_yield(values, loops)
    causes = causes if idle is None else strongest_first((*causes, idle))
    motion = with_history(loop_motion(loops), history)
    free = best.free if asserted else base.free
    about = selection.evidence if asserted else evidence
    fitted, words = free_run_values(free, about, final.sizes)
    before_damper, after_damper = (
        valve_at(z.coordinates, jnp.asarray(z.u)) for z in (base.free, free)
    )
    before, after = (np.asarray(simulate(d, motion)) for d in (before_damper, after_damper))
    energy = [
        remainder(e, s, selection.final.sizes)
        for e, s in ((raw.evidence, raw.free), (evidence, free))
    ]
    unknown = unexplained(evidence, free, energy[1], energy[0], loops.force - after)
    present = unknown.present or (not asserted and (best.strange > STRANGE or bool(best.refuted)))
    because = (*map(refuted_told, best.refuted), *unknown.because)
    unknown = replace(unknown, present=present, strange=best.strange, because=because)
    if asserted and inadequate:
        unknown = replace(unknown, because=(*unknown.because, proposal_of(best, values)))
    answer = _answer(causes, inadequate, unknown.present)
    by_model = {id(e.base): e for e in extended}
    admitted = {id(b) for b in admissible(bases)}
    rivals = tuple(
        Rival(
            model=b.fit.model,
            variant=b.fit.variant,
            held_out_nrmse=b.error if removed is None else removed.base_like(b).error,
            extended_nrmse=by_model[id(b)].error if id(b) in by_model else float("nan"),
            admissible=id(b) in admitted,
        )
        for b in bases
    )
    scores = selection.rounds[0].scores
    invisible = hidden(evidence, scores, within, {id for c in causes for id in c.members})
    whole = Diagnosis(
        answer=answer,
        causes=causes,
        invisible=invisible,
        unknown=unknown,
        gain=gain,
        screen=_screen(scores, within, plain=selection.base.sizes == NONE),
        base=next(r for r, b in zip(rivals, bases, strict=True) if b is base),
        rivals=rivals,
        fit=base.fit,
        base_damper=before_damper,
        damper=after_damper,
        symbols=fitted.symbols,
        values=fitted.values,
        covariance=fitted.covariance,
        interval=words,
        loops=loops,
        simulated_before=before,
        simulated_after=after,
        notes=(
            *(odd.words if odd else ()),
            *told(within, removed),
            *beside,
            *(needed_sizes(best) if causes else ()),
            *what_was_held_out(evidence, free),
            *_notes(best),
        ),
        open=left_open(best, causes, invisible),
        set_aside=odd,
    )
    return replace(whole, sentences=sentences(whole))


def _screen(scores: Sequence[Scored], within: Within, *, plain: bool) -> tuple[ScreenRow, ...]:
    """Scores of loops and of cycles, best first; without thresholds for loops without Σ."""
    loops = [
        ScreenRow(
            c.effect.facts.id, c.score, np.nan if plain else c.threshold, c.survival, c.expected,
            np.nan if plain else c.se,
        )
        for c in scores
    ]  # fmt: skip
    return tuple(sorted((*loops, *within.screen), key=lambda r: (-r.score, -r.survival)))


def _answer(causes: tuple[Cause, ...], inadequate: bool, unknown: bool) -> Answer:
    if inadequate:
        return "base_inadequate"
    for status in ("named", "class", "family"):
        if any(c.status == status for c in causes):
            return status
    return "unknown" if unknown else "nothing"


def _notes(best: Extended) -> tuple[str, ...]:
    final = best.selection.final
    sizes, alike = final.sizes, one_sided(final)
    if sizes == NONE:  # plain least squares knows of no errors of the rig
        return ()
    warm = f", the thermometer by {sizes.thermometer:.2g} K" if sizes.thermometer else ""
    told = () if alike is None else (alike.words,)
    large = sizes.gain > OF_A_RIG.gain or sizes.thermometer > OF_A_RIG.thermometer
    doubt = " No rig errs so much: errors of the model's laws are among these." if large else ""
    return (
        *told,
        "From test to test the force channel varies by "
        f"{100 * sizes.gain:.2g} % in gain, {sizes.offset:.2g} N in offset and "
        f"{1e3 * sizes.delay:.2g} ms in delay{warm} (estimated with the fit).{doubt}",
    )
