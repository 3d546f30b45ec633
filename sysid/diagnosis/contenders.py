"""One round of forward selection: all candidates scored, the best fitted without linearisation.

Each contender is fitted under its own discrepancy covariance; what it gains is how much more
probable it makes the measurements.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from sysid.diagnosis.at_once import at_once
from sysid.diagnosis.directions import CARRIES, one_way, share_of_its_own
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.plain import plainly_fitted, unweighted
from sysid.diagnosis.prototypes import (
    BEGINNING,
    SHRINKING,
    SIZES,
    at_size,
    shape_grid,
    size_of,
)
from sysid.diagnosis.scores import Scored, allowed, score_all
from sysid.diagnosis.signatures import signatures
from sysid.diagnosis.state import State, gained, settle
from sysid.effects.base import AbstractEffect
from sysid.effects.registry import EFFECTS
from sysid.likelihood.discrepancy import LAWS, Covariance
from sysid.likelihood.reml import fit_sizes, full_rank
from sysid.models.coordinates import place_of, valve_at
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
SHORT: Final = 0.5
"""Part of the log-likelihood that the score test promises, half of the score, below which a fit is
tried again from elsewhere."""
HOPELESS: Final = 0.2
"""Part of what the best contender gains, below which a score is not worth trying again for: next to
errors that Σ took for the laws' own, effects have gained four times their score."""
SHAPE: Final = 3.0
"""Log-likelihood that every further parameter of an effect must pay for: an end stop that begins at
the centre is a spring, and is to be called that."""
ENOUGH: Final = 1e-3
"""Tolerance of a contender's fit: what is chosen is fitted to the end."""
SMALLER: Final = tuple(0.25**k for k in range(5))
"""Where the shape of an effect changes with its size, the fit starts at the best of these parts of
the size that the score test found the effect at: from far too much play, steps lead nowhere."""
NEARBY: Final = (0.94, 0.96, 0.98, 0.99, 1.0, 1.01, 1.02, 1.04, 1.06)
"""The same for effects that begin at a size: a start that cuts loops too deep, or none at all,
tells the fit nothing of where the limit is."""
EVEN: Final = 0.1
"""Log-likelihood that puts none before another, some times what fits are accurate to: effects that
are one force in these tests would else take turns by rounding."""
LIKE_LAWS: Final = frozenset({"rate_law"})
"""Families that are themselves a change of the laws."""


@dataclass(frozen=True)
class Contender:
    """A candidate that was fitted.

    Attributes:
        scored: What the score test said.
        state: The model with it.
        gain: Log-likelihood gained over the model without it, both under their own Σ, less `SHAPE`
            for every shape parameter.
        apart: Distance √(ΔᵀΣ⁻¹Δ) of its prediction from that of the round's first contender, in
            standard errors of the model without either.
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
    tries = at_once(lambda c: _first(evidence, state, c), worth)
    likelihoods = [t.fitted.likelihood for t in tries if t.fitted is not None]
    best = max(likelihoods, default=state.likelihood) - state.likelihood
    tried = at_once(
        lambda t: _contender(evidence, state, _again(evidence, state, t, best), directions), tries
    )
    contenders = best_first(c for c in tried if c is not None)
    return Round(state, scores, tuple(from_first(state, contenders)))


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


@dataclass(frozen=True)
class _Try:
    """A fit of the model with one more effect.

    Attributes:
        scored: What the score test said of the effect.
        extended: Coordinates of the model with it.
        start: [n] where the fit starts.
        fitted: The best fit; None where it fails.
    """

    scored: Scored
    extended: DamperCoordinates
    start: Float[np.ndarray, " n"]
    fitted: State | None


def _first(evidence: Evidence, state: State, scored: Scored) -> _Try:
    """Fitted with the Σ of the model without the effect for a start."""
    extended = with_effect(state.coordinates, scored.effect)
    start = _best_start(evidence, state, extended, scored)
    return _Try(scored, extended, start, _settled(evidence, extended, start, state.covariance))


def _again(evidence: Evidence, state: State, one: _Try, best: float) -> _Try:
    """Fitted from elsewhere, where the first fit fell short of what the score promises.

    A model with one more parameter can always do as well.  Where it does worse, or gains far less
    than its score promises, the fit went astray under a Σ that hardly holds its parameters: what
    the score promises much of starts again with the Σ of its own residual, and then from least
    squares, and the best of these is taken.

    Args:
        evidence: The campaign.
        state: The model without the effect.
        one: The first fit.
        best: Log-likelihood that the best of all first fits gains.
    """
    scored, fitted = one.scored, one.fitted
    if scored.score <= max(scored.threshold, HOPELESS * best):
        return one
    if _short(fitted, state, scored):
        fitted = _better(fitted, _settled(evidence, one.extended, one.start))
    if _short(fitted, state, scored):
        plain = plainly_fitted(unweighted(evidence), one.extended, one.start)
        fitted = _better(fitted, _settled(evidence, one.extended, plain.u))
    return replace(one, fitted=fitted)


def _contender(
    evidence: Evidence, state: State, one: _Try, directions: Float[np.ndarray, "loop m effect"]
) -> Contender | None:
    """What a fit gains; None where it failed."""
    scored, fitted = one.scored, one.fitted
    if fitted is None:
        return None
    extra = fitted.u.size - state.u.size - 1
    gain = gained(fitted, state, evidence.size.force) - SHAPE * extra
    carries = scored.effect.facts.id in CARRIES
    own = 1.0 if carries else share_of_its_own(scored.signature, directions, state)
    # beside a smaller gain nobody asks
    right = gain > min(LEAST_GAIN, LEAST_IF_RIGHT) and laws_are_right(evidence, fitted)
    return Contender(scored, fitted, gain, right=right, own=own)


def _of_a_real_sign(state: State) -> bool:
    """The effect that was added last has a sign that occurs."""
    effect = valve_at(state.coordinates, jnp.asarray(state.u)).effects[-1]
    return allowed(effect, size_of(effect))


def _short(fitted: State | None, before: State, scored: Scored) -> bool:
    """A fit that failed, or gains less than `SHORT` of what the score test promises."""
    promised = 0.5 * SHORT * scored.score
    return fitted is None or fitted.likelihood < before.likelihood + promised


def _better(one: State | None, other: State | None) -> State | None:
    if one is None or (other is not None and other.likelihood > one.likelihood):
        return other
    return one


def _settled(
    evidence: Evidence,
    coordinates: DamperCoordinates,
    u: Float[np.ndarray, " n"],
    covariance: Covariance | None = None,
) -> State | None:
    """The model with one more effect, fitted; None where that fails or ends at no real sign."""
    try:
        state = settle(evidence, coordinates, u, covariance, tolerance=ENOUGH)
    except (ValueError, np.linalg.LinAlgError):
        return None
    return state if _of_a_real_sign(state) else None


def with_effect(coordinates: DamperCoordinates, effect: AbstractEffect) -> DamperCoordinates:
    """Coordinates of a damper with one more effect."""
    return DamperCoordinates(coordinates.valve_coordinates, (*coordinates.prototypes, effect))


def _best_start(
    evidence: Evidence, state: State, extended: DamperCoordinates, scored: Scored
) -> Float[np.ndarray, " n"]:
    """Where the fit starts: the size from which one linear step of the model before ends best.

    The size that the score test found will do, unless the effect is known to change its shape with
    it or that step ends worse than the model is without the effect.
    """
    id = scored.effect.facts.id
    parts = SMALLER if id in SHRINKING else NEARBY if id in BEGINNING else ()
    if not parts:
        whole = start_with(state, extended, scored)
        r = state.gls.residual[:, :, None]
        without = float(state.covariance.inner(r, r)[0, 0])
        if _after_a_step(evidence, state, extended, whole) <= without:
            return whole
        parts = SMALLER
    starts = [start_with(state, extended, scored, part) for part in parts]
    return min(starts, key=lambda u: _after_a_step(evidence, state, extended, u))


def _after_a_step(
    evidence: Evidence, state: State, extended: DamperCoordinates, u: Float[np.ndarray, " n"]
) -> float:
    """rᵀΣ⁻¹r that is left after a linear step of the parameters that the model before has."""
    residual, jacobian = evidence.look(extended, u)
    if not (np.isfinite(residual).all() and np.isfinite(jacobian).all()):
        return np.inf
    own = full_rank(jacobian[:, :, : state.u.size])
    both = np.concatenate([own, residual[:, :, None]], axis=2)
    gram = state.covariance.inner(both, both)
    taken = gram[:-1, -1] @ np.linalg.lstsq(gram[:-1, :-1], gram[:-1, -1])[0]
    return float(gram[-1, -1] - taken)


def start_with(
    state: State, extended: DamperCoordinates, scored: Scored, part: float = 1.0
) -> Float[np.ndarray, " n"]:
    """A start of an extended model: some part of the score test's size, everything else kept."""
    damper = valve_at(state.coordinates, jnp.asarray(state.u))
    effect, symbol = scored.effect, scored.effect.facts.size
    size = float(scored.expected)
    if effect.facts.id in SIZES:
        size = float(getattr(effect, symbol)) * np.sign(size)
    place = np.asarray(place_of(extended, damper.with_effect(at_size(effect, part * size))))
    return np.concatenate([state.u, place[state.u.size :]])


def best_first(contenders: Iterable[Contender]) -> list[Contender]:
    """Contenders by what they gain; where several gain as much, the catalogue's first leads.

    Args:
        contenders: In any order.
    """
    ordered = sorted(contenders, key=lambda c: -c.gain)
    if not ordered:
        return []
    level = [c for c in ordered if c.gain > ordered[0].gain - EVEN]
    leads = min(level, key=lambda c: EFFECTS.index(type(c.scored.effect)))
    return [leads, *(c for c in ordered if c is not leads)]


def from_first(before: State, contenders: Sequence[Contender]) -> list[Contender]:
    """Contenders with their distance from the first of them (`Contender.apart`).

    Args:
        before: The model without any of them.
        contenders: In their order.
    """
    if not contenders:
        return []
    best = contenders[0].state
    apart = []
    for one in contenders:
        difference = (one.state.gls.residual - best.gls.residual)[:, :, None]
        squared = float(before.covariance.inner(difference, difference)[0, 0])
        apart.append(np.sqrt(max(squared, 0.0)))
    return [replace(c, apart=float(a)) for c, a in zip(contenders, apart, strict=True)]
