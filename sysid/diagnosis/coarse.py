"""Effects that are missing altogether: found by least squares and held-out error alone.

Where a base model is wrong by a tenth of the force, its error is no small perturbation with a
covariance: the covariance would have to be as large as the loops, and every effect could hide in
it.  Then tests count by 1/max|F|, candidates are fitted without linearisation, and one is added if
the conditions that it has not seen are predicted better by it.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

import jax.numpy as jnp
import numpy as np

from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.held_out import leave_conditions_out
from sysid.diagnosis.plain import plainly_fitted
from sysid.diagnosis.prototypes import Magnitudes, magnitude, prototypes
from sysid.diagnosis.scores import Scored
from sysid.diagnosis.selection import (
    Contender,
    Round,
    Selection,
    between_tests,
    score_candidates,
    start_with,
    with_effect,
)
from sysid.diagnosis.state import State
from sysid.effects.base import AbstractEffect
from sysid.models.coordinates import valve_at
from sysid.parameters import specs

COARSE: Final = 0.07
"""In-sample RMSE/max|F| from which a base model counts as wrong altogether."""
WORTH: Final = 0.05
"""Part by which a further effect must lower the held-out error."""
TRIED: Final = 3
"""Candidates fitted in each round, beside those whose shape changes with their size."""
BEYOND: Final = 1.5
"""A size may exceed the realistic range by this factor."""
LONGER: Final = 4.0
"""The stroke of a damper may be so many times the largest travel of its tests, which seldom use it
whole.  Play and springs in series scale with the damper's stroke, not with that of its tests."""
BY_SIZE: Final = frozenset(
    {"series_compliance", "seating_leakage", "backlash", "entrained_air", "bypass_leakage"}
)
"""A linear score says little about these before they are fitted."""


def select_coarsely(
    evidence: Evidence, base: State, *, most: int, progress: Callable[[str], None]
) -> Selection:
    """Add effects while conditions that were not seen are predicted better.

    Args:
        evidence: The campaign, `unweighted`.
        base: The base model, `plainly_fitted`.
        most: Effects to add at most.
        progress: Called with a line a round.
    """
    candidates = [e for e in prototypes(evidence.size) if between_tests(e)]
    state, rounds = base, []
    error = float(leave_conditions_out(evidence, state).mean())
    while True:
        scores = score_candidates(evidence, state, candidates)
        contenders = _contenders(evidence, state, scores) if len(rounds) < most else ()
        taken = None
        for k, one in enumerate(contenders):
            new = float(leave_conditions_out(evidence, one.state).mean())
            if new < (1.0 - WORTH) * error:
                progress(f"{one.id} lowers the held-out error to {100 * new:.2f} %")
                taken, error = one, new
                contenders = (one, *contenders[:k], *contenders[k + 1 :])
                break
        rounds.append(Round(state, scores, contenders if taken else ()))
        if taken is None:
            return Selection(base, tuple(rounds), state.ids, state)
        state = taken.state
        candidates = [e for e in candidates if e.facts.id != taken.id]


def plausible(evidence: Evidence, state: State) -> bool:
    """The size of the last effect is one that real dampers and rigs have.

    An error of a tenth of the force can be lowered by many an effect of absurd size (16 kg of
    fixture, a filter at 26 Hz), which then stands in for another.
    """
    effect = valve_at(state.coordinates, jnp.asarray(state.u)).effects[-1]
    return abs(float(getattr(effect, effect.facts.size))) <= largest(effect, evidence.size)


def largest(effect: AbstractEffect, size: Magnitudes) -> float:
    """Largest size that an effect may have on the damper of a campaign."""
    facts = effect.facts
    spec = next(s for s in specs(effect) if s.symbol == facts.size)
    strokes = (size.travel, LONGER * size.travel)
    scale = max(magnitude(spec.unit, replace(size, stroke=stroke)) for stroke in strokes)
    return BEYOND * max(abs(z) for z in facts.realistic[facts.size]) * scale


def _contenders(
    evidence: Evidence, state: State, scores: Sequence[Scored]
) -> tuple[Contender, ...]:
    """The best candidates by score, and all whose shape changes with their size, fitted."""
    chosen = [c for c in scores if c.visible and c.effect.facts.id in BY_SIZE]
    others = [c for c in scores if c.visible and c.score > 0.0 and c not in chosen]
    found = []
    for scored in (*chosen, *others[:TRIED]):
        extended = with_effect(state.coordinates, scored.effect)
        try:
            fitted = plainly_fitted(evidence, extended, start_with(state, extended, scored))
        except (ValueError, np.linalg.LinAlgError):
            continue
        if not plausible(evidence, fitted):
            continue
        found.append(Contender(scored, fitted, fitted.likelihood - state.likelihood))
    found.sort(key=lambda c: -c.gain)
    return tuple(c for c in found if c.gain > 0.0)
