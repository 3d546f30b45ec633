"""Forward selection of effects with refit, then a backward check.

One effect at a time: the score test ranks all candidates, the best few are fitted without
linearisation, each under its own discrepancy covariance, and the one that makes the measurements
most probable is added if it passes.  What is added first can become superfluous; the backward
check takes such an effect out again.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from sysid.diagnosis.absorbed import likeness
from sysid.diagnosis.at_once import at_once
from sysid.diagnosis.compiled import make_room
from sysid.diagnosis.directions import CARRIES, one_way, share_of_its_own
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.plain import plainly_fitted, unweighted
from sysid.diagnosis.prototypes import NEED_CYCLES, SIZES, prototypes, shape_grid
from sysid.diagnosis.remainder import remainder
from sysid.diagnosis.scores import Scored, score_all
from sysid.diagnosis.signatures import signatures
from sysid.diagnosis.state import State, settle
from sysid.effects.base import AbstractEffect
from sysid.likelihood.discrepancy import LAWS, Covariance
from sysid.likelihood.reml import fit_sizes
from sysid.models.coordinates import place_of, valve_at
from sysid.models.damper import Damper
from sysid.models.damper_coordinates import DamperCoordinates

STRUCTURAL: Final = ("odd", "even", *LAWS)
"""Parts of Σ for errors of the model."""
CONTENDERS: Final = 5
"""Candidates that are fitted without linearisation in each round."""
NEAR: Final = 0.5
"""Part of the threshold from which on a candidate is fitted if it is one of the best few: where an
effect acts the same way in all tests, Σ first takes it for an error of the rig, and its score is
half of what it gains."""
LEAST_GAIN: Final = 12.0
"""Log-likelihood that a refit must gain where laws err: what looks like an effect in errors whose
form Σ only guesses gains up to about 10."""
LEAST_IF_RIGHT: Final = 7.5
"""The same where the laws are right: as much as the threshold of the score test asks for, half of
χ²₁ at `FALSE_ALARM` for all candidates and shapes."""
RIGHT: Final = 0.1
"""Share of what a model leaves that Σ takes for errors of its structure, below which its laws are
right.  Without such errors it is below .05, with errors of 2 % above .8."""
WRONG: Final = 0.7
"""Share from which they are wrong.  Between the two it is asked whether Σ needs such errors."""
NEEDED: Final = 6.3
"""Restricted log-likelihood that they must be worth: half of χ² at 5 % for their six sizes."""

SHAPE: Final = 3.0
"""Log-likelihood that every further parameter of an effect must pay for: an end stop that begins at
the centre is a spring, and is to be called that."""

WEAK: Final = 0.05
"""Part of what the first effect gained that a further one must gain at least: what the first one's
formula misses, being a little different from the damper's own physics, is no second cause."""
AGAIN: Final = 0.5
"""The same for an effect of a family that the model already has: what a formula misses looks most
like its own family."""
UNLIKE: Final = 0.1
"""cos² of two signatures below which the one is nothing that the other's formula misses, though
both are of one family: a preload and its change with temperature."""
LIKE_LAWS: Final = frozenset({"rate_law"})
"""Families that are themselves a change of the laws."""
OF_LAWS: Final = 0.5
"""Part of what is left that such an effect must explain: where laws err, part of the error always
looks like one of them."""


@dataclass(frozen=True)
class Contender:
    """A candidate that was fitted.

    Attributes:
        scored: What the score test said.
        state: The model with it.
        gain: Log-likelihood gained over the model without it, both under their own Σ, less `SHAPE`
            for every shape parameter.
        apart: Distance √(ΔᵀΣ⁻¹Δ) of its prediction from the best contender's, in standard errors
            of the model without either.
        right: The laws are right beside it (`laws_are_right`).
        own: Part of its score that stays where effects that the model has may act otherwise in one
            direction than in the other (`directions`).
    """

    scored: Scored
    state: State
    gain: float
    apart: float = 0.0
    right: bool = False
    own: float = 1.0

    @property
    def least(self) -> float:
        """Log-likelihood that it must gain."""
        return LEAST_IF_RIGHT if self.right else LEAST_GAIN

    @property
    def id(self) -> str:
        """Of the effect."""
        return self.scored.effect.facts.id


@dataclass(frozen=True)
class Round:
    """One round of forward selection.

    Attributes:
        before: The model that was to be extended.
        scores: All candidates, best first.
        contenders: Those that were fitted, best first.
        passed_over: Those that were better, but of a family that the model already has.
    """

    before: State
    scores: tuple[Scored, ...]
    contenders: tuple[Contender, ...]
    passed_over: tuple[Contender, ...] = ()

    @property
    def families(self) -> frozenset[str]:
        """Of the effects that the model already has."""
        return frozenset(e.facts.family for e in self.before.coordinates.prototypes)


@dataclass(frozen=True)
class Selection:
    """What forward selection and backward check came to.

    Attributes:
        base: The model without effects.
        rounds: One for every effect that was added, and the last, in which none was.
        kept: Ids of the effects that stayed.
        final: The model with them.
    """

    base: State
    rounds: tuple[Round, ...]
    kept: tuple[str, ...]
    final: State


def select(
    evidence: Evidence,
    base: State,
    *,
    most: int,
    progress: Callable[[str], None],
) -> Selection:
    """Add effects while they pay.

    Args:
        evidence: The campaign.
        base: The base model, fitted.
        most: Effects to add at most.
        progress: Called with a line a round.
    """
    found_from = ("loops", "history") if evidence.history else ("loops",)
    candidates = [e for e in prototypes(evidence.size, found_from) if between_tests(e, evidence)]
    state, rounds, gained = base, [], {}
    while True:
        make_room()
        one = play(evidence, state, candidates, full=len(state.ids) >= most)
        news = _news(one, rounds)
        best = worth_adding(one, gained, news)
        while best is not None and not _explains_laws(evidence, state, best):
            progress(f"{best.id} explains too little of what is left to be a law of its own")
            others = tuple(c for c in one.contenders if c is not best)
            one = replace(one, contenders=others)
            best = worth_adding(one, gained, news)
        rounds.append(one if best is None else _with_first(one, best))
        if best is None:
            break
        progress(f"{best.id} raises the log-likelihood by {best.gain:.0f}")
        family = best.scored.effect.facts.family
        gained[family] = max(best.gain, gained.get(family, 0.0))
        state = best.state
        candidates = [e for e in candidates if e.facts.id != best.id]
    final = _backward(evidence, state)
    return Selection(base, tuple(rounds), final.ids, final)


def _news(one: Round, earlier: Sequence[Round]) -> frozenset[str]:
    """Ids of contenders that look like none of the effects that were added before them."""
    return frozenset(c.id for c in one.contenders if all(unlike(c, before) for before in earlier))


def unlike(contender: Contender, before: Round) -> bool:
    """A contender of a later round is nothing that the effect of this round missed."""
    first, state = before.contenders[0], before.before
    alike = likeness(
        contender.scored.signature, first.scored.signature, state.gls.jacobian, state.covariance
    )
    return alike < UNLIKE


def worth_adding(
    one: Round, gained: Mapping[str, float], news: Collection[str] = ()
) -> Contender | None:
    """The best contender that is a cause of its own; None if there is none.

    What it gains must not be what effects that the model has leave, acting otherwise in the two
    directions than their formulas do.

    A change of the laws that leaves them right need not be strong beside other effects; one that
    Σ hid and that leaves them wrong is an error of the laws like others.

    Args:
        one: The round.
        gained: Log-likelihood that the effects of each family gained when they were added.
        news: Ids of effects that look like none of these, of whatever family.
    """
    weak = WEAK * max(gained.values(), default=0.0)
    for contender in one.contenders:
        family = contender.scored.effect.facts.family
        again = 0.0 if contender.id in news else AGAIN * gained.get(family, 0.0)
        if family in LIKE_LAWS and contender.right:
            enough = max(contender.least, again)
        elif family in LIKE_LAWS and contender.scored.score <= contender.scored.threshold:
            continue
        else:
            enough = max(contender.least, again, weak)
        if contender.gain > enough and contender.own * contender.gain > contender.least:
            return contender
    return None


def laws_are_right(evidence: Evidence, state: State) -> bool:
    """Σ finds next to nothing but noise and errors of the rig in what a model leaves.

    Few tests tell an error of the laws from one of the rig: a smooth error of scale takes up what
    the load cell does to neighbours alike, and has a share, though Σ is as probable without it.

    Args:
        evidence: The campaign.
        state: A model fitted under its own Σ.
    """
    r = state.gls.residual
    structural = evidence.energy(state.covariance.expected(r, STRUCTURAL)) / evidence.energy(r)
    if not RIGHT <= structural < WRONG:
        return bool(structural < RIGHT)
    without = fit_sizes(
        evidence.parts, r, state.gls.jacobian, state.sizes, absent=STRUCTURAL
    ).log_likelihood
    return state.restricted.log_likelihood - without < NEEDED


def _explains_laws(evidence: Evidence, before: State, contender: Contender) -> bool:
    """An effect that changes the laws explains most of what they are off by, in free run."""
    if contender.scored.effect.facts.family not in LIKE_LAWS:
        return True
    if contender.right:
        return True
    plain = unweighted(evidence)
    left = [
        remainder(evidence, plainly_fitted(plain, s.coordinates, s.u), contender.state.sizes)
        for s in (before, contender.state)
    ]
    return left[1].reducible <= (1.0 - OF_LAWS) * left[0].reducible


def _with_first(one: Round, chosen: Contender) -> Round:
    """The round with the chosen contender first."""
    place = one.contenders.index(chosen)
    behind = one.contenders[place:]
    return replace(one, contenders=behind, passed_over=one.contenders[:place])


def between_tests(effect: AbstractEffect, evidence: Evidence) -> bool:
    """Cycle means, the order of tests and what was recorded of temperature suffice to see it."""
    id = effect.facts.id
    if id == "surface_temperature" and not np.isfinite(evidence.loops.temperature).all():
        return False
    return id not in NEED_CYCLES


def play(
    evidence: Evidence, state: State, candidates: Sequence[AbstractEffect], *, full: bool = False
) -> Round:
    """One round: score all candidates, fit the best.

    Args:
        evidence: The campaign.
        state: The model so far.
        candidates: At nominal values.
        full: Only score.
    """
    scores = score_candidates(evidence, state, candidates)
    if full:
        return Round(state, scores, ())
    hidden = not laws_are_right(evidence, state)
    worth = _worth_a_fit(scores, hidden=hidden)
    directions = one_way(evidence, state)
    tried = at_once(lambda c: _fitted(evidence, state, c, directions), worth)
    contenders = sorted((c for c in tried if c is not None), key=lambda c: -c.gain)
    return Round(state, scores, tuple(_distances(state, contenders)))


def _worth_a_fit(scores: Sequence[Scored], *, hidden: bool) -> list[Scored]:
    """The best few; where Σ has errors of the laws also changes of the laws, which it hides."""
    best = [c for c in scores if c.score > NEAR * c.threshold][:CONTENDERS]
    laws = [c for c in scores if c.effect.facts.family in LIKE_LAWS and c.score > 0.0]
    return best + [c for c in laws if hidden and c not in best]


def score_candidates(
    evidence: Evidence, state: State, candidates: Sequence[AbstractEffect]
) -> tuple[Scored, ...]:
    """Score test of every candidate beside the effects that a model already has."""
    shapes = [shape for effect in candidates for shape in shape_grid(effect, evidence.size)]
    damper = valve_at(state.coordinates, jnp.asarray(state.u))
    alone = signatures(evidence, damper.valve, shapes)
    return score_all(shapes, alone, state.gls.residual, state.gls.jacobian, state.covariance)


def _fitted(
    evidence: Evidence, state: State, scored: Scored, directions: Float[np.ndarray, "loop m effect"]
) -> Contender | None:
    """The model with one more effect, fitted; None where the fit fails.

    A model with one more parameter can always do as well.  Where it does worse, the fit went astray
    under a Σ that hardly holds its parameters: what the score promises much of starts again with
    the Σ of its own residual, and then from least squares.
    """
    extended = with_effect(state.coordinates, scored.effect)
    start = start_with(state, extended, scored)
    fitted = _settled(evidence, extended, start, state.covariance)
    promising = scored.score > scored.threshold
    if promising and _worse(fitted, state):
        fitted = _settled(evidence, extended, start)
    if promising and _worse(fitted, state):
        plain = plainly_fitted(unweighted(evidence), extended, start)
        fitted = _settled(evidence, extended, plain.u)
    if fitted is None:
        return None
    extra = fitted.u.size - state.u.size - 1
    gain = fitted.likelihood - state.likelihood - SHAPE * extra
    carries = scored.effect.facts.id in CARRIES
    own = 1.0 if carries else share_of_its_own(scored.signature, directions, state)
    return Contender(scored, fitted, gain, right=laws_are_right(evidence, fitted), own=own)


def _worse(fitted: State | None, before: State) -> bool:
    return fitted is None or fitted.likelihood < before.likelihood


def _settled(
    evidence: Evidence,
    coordinates: DamperCoordinates,
    u: Float[np.ndarray, " n"],
    covariance: Covariance | None = None,
) -> State | None:
    try:
        return settle(evidence, coordinates, u, covariance)
    except (ValueError, np.linalg.LinAlgError):
        return None


def with_effect(coordinates: DamperCoordinates, effect: AbstractEffect) -> DamperCoordinates:
    """Coordinates of a damper with one more effect."""
    return DamperCoordinates(coordinates.valve_coordinates, (*coordinates.prototypes, effect))


def start_with(
    state: State, extended: DamperCoordinates, scored: Scored
) -> Float[np.ndarray, " n"]:
    """Where the fit of an extended model starts: the score test's size, everything else kept."""
    damper = valve_at(state.coordinates, jnp.asarray(state.u))
    effect, symbol = scored.effect, scored.effect.facts.size
    size = scored.expected
    if effect.facts.id in SIZES:
        size = float(getattr(effect, symbol)) * np.sign(size)
    sized = eqx.tree_at(lambda e: getattr(e, symbol), effect, jnp.asarray(np.float64(size)))
    place = np.asarray(place_of(extended, damper.with_effect(sized)))
    return np.concatenate([state.u, place[state.u.size :]])


def _distances(before: State, contenders: Sequence[Contender]) -> list[Contender]:
    if not contenders:
        return []
    best = contenders[0].state
    apart = []
    for one in contenders:
        difference = (one.state.gls.residual - best.gls.residual)[:, :, None]
        squared = float(before.covariance.inner(difference, difference)[0, 0])
        apart.append(np.sqrt(max(squared, 0.0)))
    return [replace(c, apart=float(a)) for c, a in zip(contenders, apart, strict=True)]


def _backward(evidence: Evidence, state: State) -> State:
    """Take out effects, one at a time, that are no longer worth keeping."""
    while len(state.ids) > 1:
        enough = LEAST_IF_RIGHT if laws_are_right(evidence, state) else LEAST_GAIN
        all_but_one = at_once(partial(without, evidence, state), range(len(state.ids)))
        smaller = max(all_but_one, key=lambda s: s.likelihood)
        if state.likelihood - smaller.likelihood > enough:
            break
        state = smaller
    return state


def without(evidence: Evidence, state: State, index: int) -> State:
    """The model without one of its effects, fitted again."""
    damper = valve_at(state.coordinates, jnp.asarray(state.u))
    kept = [k for k in range(len(damper.effects)) if k != index]
    coordinates = DamperCoordinates(
        state.coordinates.valve_coordinates,
        tuple(state.coordinates.prototypes[k] for k in kept),
    )
    smaller = Damper(damper.valve, tuple(damper.effects[k] for k in kept))
    start = np.array(place_of(coordinates, smaller))
    start[: coordinates.valve_coordinates.size] = state.u[: coordinates.valve_coordinates.size]
    return settle(evidence, coordinates, start, state.covariance)
