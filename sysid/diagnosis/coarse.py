"""Effects that are missing altogether: found by least squares and held-out error alone.

Where a base model is wrong by a tenth of the force, its error is no small perturbation with a
covariance: the covariance would have to be as large as the loops, and every effect could hide in
it.  Then tests count by 1/max|F|, candidates are fitted without linearisation, and one is added if
the conditions that it has not seen are predicted better by it.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Final

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from sysid.diagnosis.at_once import at_once
from sysid.diagnosis.compiled import make_room
from sysid.diagnosis.contenders import (
    SHAPE,
    Contender,
    Round,
    best_first,
    score_candidates,
    start_with,
    with_effect,
)
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.held_out import errors_in_blocks
from sysid.diagnosis.plain import INDEPENDENT, STEPS, plain_distance, plainly_fitted
from sysid.diagnosis.prototypes import (
    Magnitudes,
    magnitude,
    magnitudes,
    prototypes,
    shape_grid,
    size_of,
)
from sysid.diagnosis.scores import Scored, allowed
from sysid.diagnosis.selection import Selection, between_tests
from sysid.diagnosis.state import State
from sysid.effects.base import AbstractEffect
from sysid.models.coordinates import place_of, valve_at
from sysid.models.damper import Damper
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.parameters import specs

COARSE: Final = 0.07
"""Error of the base (`Base.in_sample`) from which it counts as wrong altogether."""
WORTH: Final = 0.05
"""Part by which a further effect must lower the held-out error."""
TRIED: Final = 3
"""Candidates fitted in each round, beside those whose shape changes with their size."""
PROMISING: Final = 0.25
"""Part of what an error lower by `WORTH` gains on the tests that a candidate is fitted to, below
which it is not held against others."""
BARELY: Final = 0.1
"""Part of the best one's gain below which an effect is of no use."""
FEW: Final = 3
"""Gauss–Newton steps in which the shapes of one effect are compared."""
QUICK: Final = 8
"""Gauss–Newton steps in which a candidate shows whether it is worth more of them."""
FINALISTS: Final = 3
"""Candidates of a round that get as many steps as they need, and are held against unseen tests."""
BLOCKS: Final = 8
"""Blocks at most in which conditions are left out: of three finalists a round, the whole matrix of
33 conditions would be predicted a hundred times."""
ROUGH: Final = 0.05
"""Tolerance of fits during the search: of 20 loops a step that lowers the cost by less than a
ten-thousandth ends them."""
AS_GOOD: Final = 1e-3
"""Part of the held-out error that puts no finalist before another: fits to blocks say no more."""
BEYOND: Final = 1.5
"""A size may exceed the realistic range by this factor."""
BY_SIZE: Final = frozenset(
    {"series_compliance", "seating_leakage", "backlash", "entrained_air", "bypass_leakage"}
)
"""A linear score says little about these before they are fitted."""


def select_coarsely(
    evidence: Evidence, base: State, *, most: int, progress: Callable[[str], None]
) -> Selection:
    """Add effects while conditions that were not seen are predicted better.

    Where none does it alone, the best are tried with a second one beside them: a spring and a leak
    may each be of no use without the other.  Where nothing pays any more, those that were laid
    aside as useless are tried again, each once: a leak is of no use as long as laws that are wrong
    by more hide it, and may be the largest that is missing once the others are there.

    Args:
        evidence: The campaign, `unweighted`.
        base: The base model, `plainly_fitted`.
        most: Effects to add at most.
        progress: Called with a line a round.
    """
    whole, evidence = evidence, _of_the_damper(evidence)
    known = prototypes(evidence.size)
    candidates = [e for e in known if between_tests(e, evidence, thermal=False)]
    aside = list[AbstractEffect]()
    again: frozenset[str] = frozenset()
    state, rounds = base, []
    error = _unseen(evidence, state)
    while True:
        make_room()
        scores = score_candidates(evidence, state, candidates)
        room = most - len(rounds)
        contenders = _contenders(evidence, base, state, scores) if room > 0 else ()
        if contenders:
            gains = [f"{c.id} {c.gain:.0f}" for c in contenders]
            progress(f"log-likelihood gained: {', '.join(gains)}")
        taken, error = _best_unseen(evidence, contenders, error)
        if taken:
            rounds.append(Round(state, scores, _put_first(state, taken, contenders)))
        elif room > 1:
            taken, pair, error = _together(evidence, state, scores, contenders, candidates, error)
            rounds.extend(pair)
        if taken is None and room > 0 and aside:
            again |= {e.facts.id for e in aside}
            candidates, aside = [*candidates, *aside], []
            continue
        if taken is None:
            final = plainly_fitted(evidence, state.coordinates, state.u) if rounds else state
            rounds.append(Round(state, scores, ()))
            return Selection(base, tuple(rounds), final.ids, final, whole)
        progress(f"{taken.id} lowers the held-out error to {100 * error:.2f} %")
        useless = _useless(state, contenders)
        candidates, aside = (
            [e for e in some if e.facts.id not in taken.state.ids] for some in (candidates, aside)
        )
        aside += [e for e in candidates if e.facts.id in useless - again]
        candidates = [e for e in candidates if e.facts.id not in useless]
        state = taken.state


def _of_the_damper(evidence: Evidence) -> Evidence:
    """The campaign with candidates as large as befits the damper, which is known by its travel.

    The median amplitude, which the score goes by, may be a tenth of that; a fit that starts from
    play or a leak of a tenth of its size does not arrive.
    """
    return replace(evidence, size=replace(evidence.size, stroke=evidence.size.travel))


def _useless(state: State, contenders: Sequence[Contender]) -> frozenset[str]:
    """Play, leaks and springs that are of no use even beside another one; laid aside."""
    if not BY_SIZE.intersection(state.ids):
        return frozenset()
    least = BARELY * max((c.gain for c in contenders), default=0.0)
    return BY_SIZE - {c.id for c in contenders if c.gain > least}


def _unseen(evidence: Evidence, state: State) -> float:
    """Mean error on conditions left out, to its third digit."""
    return float(errors_in_blocks(evidence, state, BLOCKS, ROUGH)[0].mean())


def _best_unseen(
    evidence: Evidence, contenders: Sequence[Contender], error: float
) -> tuple[Contender | None, float]:
    """The finalist that predicts best, and the error with it; none if none is worth adding.

    Where a base is far off, likelihoods of two stand-ins for the same fault hardly differ, and the
    one that is ahead may be the one that holds on these tests alone.  Of those that predict equally
    well the likelier is taken.
    """
    least = worth_asking(evidence.tests)
    promising = [one for one in contenders[:FINALISTS] if one.gain > least]
    unseen = [(_unseen(evidence, one.state), one) for one in promising]
    least_error = min((new for new, _ in unseen), default=error)
    new, best = next((p for p in unseen if p[0] <= (1.0 + AS_GOOD) * least_error), (error, None))
    return (best, new) if new < (1.0 - WORTH) * error else (None, error)


def worth_asking(tests: int) -> float:
    """Log-likelihood that a candidate must gain before it is held against tests it has not seen.

    What lowers the errors of all tests by `WORTH` gains INDEPENDENT · tests · −ln(1 − WORTH).  What
    gains less than a part of that on tests that it is fitted to does not do it on others.

    Args:
        tests: L.
    """
    return -PROMISING * INDEPENDENT * tests * float(np.log1p(-WORTH))


def _together(
    evidence: Evidence,
    state: State,
    scores: tuple[Scored, ...],
    contenders: tuple[Contender, ...],
    candidates: Sequence[AbstractEffect],
    error: float,
) -> tuple[Contender | None, list[Round], float]:
    """Two rounds at once, of effects whose shape changes with their size; else none.

    Where the model has such an effect already, each of them had its partner when it was tried.
    """
    if BY_SIZE.intersection(state.ids):
        return None, [], error
    for one in [c for c in contenders[:FINALISTS] if c.id in BY_SIZE]:
        others = [e for e in candidates if e.facts.id in BY_SIZE - {one.id}]
        beside = score_candidates(evidence, one.state, others)
        seconds = _contenders(evidence, state, one.state, beside)
        second, new = _best_unseen(evidence, seconds[:1], error)
        if second:
            first = Round(state, scores, _put_first(state, one, contenders))
            last = Round(one.state, beside, _put_first(one.state, second, seconds))
            return second, [first, last], new
    return None, [], error


def _put_first(
    before: State, one: Contender, contenders: Sequence[Contender]
) -> tuple[Contender, ...]:
    """The chosen one before the others, each with its distance from it."""
    ordered = (one, *(c for c in contenders if c is not one))
    return tuple(replace(c, apart=plain_distance(before, one.state, c.state)) for c in ordered)


def plausible(evidence: Evidence, state: State) -> bool:
    """The size of the last effect is one that real dampers and rigs have, and of their sign.

    An error of a tenth of the force can be lowered by many an effect of absurd size (16 kg of
    fixture, a filter at 26 Hz), which then stands in for another.
    """
    effect = valve_at(state.coordinates, jnp.asarray(state.u)).effects[-1]
    own = magnitudes(evidence.loops)  # whatever candidates are scored at
    size = size_of(effect)
    return allowed(effect, size) and abs(size) <= largest(effect, own)


def largest(effect: AbstractEffect, size: Magnitudes) -> float:
    """Largest size that an effect may have on the damper of a campaign.

    What is long in a campaign may be its median amplitude or its travel: the limit is the larger
    one by either, so that no effect is refused at the size that it is scored at.

    Args:
        effect: Of any size.
        size: Of the campaign.

    Returns:
        In the unit of the effect's size parameter.
    """
    facts = effect.facts
    spec = next(s for s in specs(effect) if s.symbol == facts.size)
    scale = max(magnitude(spec.unit, replace(size, stroke=z)) for z in (size.stroke, size.travel))
    return BEYOND * max(abs(z) for z in facts.realistic[facts.size]) * scale


def _contenders(
    evidence: Evidence, base: State, state: State, scores: Sequence[Scored]
) -> tuple[Contender, ...]:
    """The best candidates by score, and all whose shape changes with their size, fitted.

    All get a few steps, the best of them as many as they need.  Best first.
    """
    chosen = [c for c in scores if c.visible and c.effect.facts.id in BY_SIZE]
    others = [c for c in scores if c.visible and c.score > 0.0 and c not in chosen]
    beginnings = _beginnings(base, state)

    def begin(c: Scored) -> list[Contender | None]:
        return [_best_shape(evidence, state, damper, c) for damper in beginnings]

    begun = [one for some in at_once(begin, chosen) for one in some if one is not None]
    starts = [(c.scored, c.state.coordinates, c.state.u) for c in begun]
    for c in others[:TRIED]:
        extended = with_effect(state.coordinates, c.effect)
        starts.append((c, extended, start_with(state, extended, c)))
    tried = at_once(lambda start: _tried(evidence, state, *start, QUICK), starts)
    found = _one_each(c for c in tried if c is not None)
    finalists = at_once(
        lambda c: _tried(evidence, state, c.scored, c.state.coordinates, c.state.u, STEPS),
        found[:FINALISTS],
    )
    kept = [c for c in finalists if c is not None and plausible(evidence, c.state)]
    kept += [c for c in found[FINALISTS:] if plausible(evidence, c.state)]
    return tuple(best_first(c for c in kept if c.state.likelihood > state.likelihood))


def _one_each(tried: Iterable[Contender]) -> list[Contender]:
    """The better fit of every effect and form, best first."""
    best: dict[object, Contender] = {}
    for one in sorted(tried, key=lambda c: -c.gain):
        best.setdefault(jax.tree.structure(one.scored.effect), one)
    return list(best.values())


def _beginnings(base: State, state: State) -> tuple[Damper, ...]:
    """Where fits with one more effect begin: the damper so far, and one that has to start afresh.

    A leak and a spring that are both there stand for other things than each alone, and from what
    one alone had come to the fit does not find the way.  So play, leaks and springs go back to
    their usual size, and the valve to what it was without any of them.
    """
    damper = valve_at(state.coordinates, jnp.asarray(state.u))
    if not any(e.facts.id in BY_SIZE for e in damper.effects):
        return (damper,)
    valve = valve_at(base.coordinates, jnp.asarray(base.u)).valve
    effects = tuple(
        usual if now.facts.id in BY_SIZE else now
        for usual, now in zip(state.coordinates.prototypes, damper.effects, strict=True)
    )
    return damper, Damper(valve, effects)


def _best_shape(
    evidence: Evidence, state: State, begin: Damper, scored: Scored
) -> Contender | None:
    """The effect in the best of its shapes after a few steps: no linear score tells which it is."""
    size = scored.effect.facts.size
    shapes = [
        e
        for proto in prototypes(evidence.size)
        if jax.tree.structure(proto) == jax.tree.structure(scored.effect)
        for e in shape_grid(proto, evidence.size)
        if getattr(e, size) == getattr(proto, size)
    ]
    extended = with_effect(state.coordinates, scored.effect)
    found = []
    for effect in (scored.effect, *shapes):
        start = np.asarray(place_of(extended, begin.with_effect(effect)))
        one = _tried(evidence, state, scored, extended, start, FEW)
        if one is not None:
            found.append(one)
    return max(found, key=lambda c: c.gain, default=None)


def _tried(
    evidence: Evidence,
    state: State,
    scored: Scored,
    extended: DamperCoordinates,
    start: Float[np.ndarray, " n"],
    steps: int,
) -> Contender | None:
    """A candidate after so many steps; None where it cannot be simulated.

    Its further parameters are paid for as under Σ: an end stop is a gas spring with one more.
    """
    try:
        fitted = plainly_fitted(evidence, extended, start, steps, ROUGH)
    except (ValueError, np.linalg.LinAlgError):
        return None
    extra = fitted.u.size - state.u.size - 1
    return Contender(scored, fitted, fitted.likelihood - state.likelihood - SHAPE * extra)
