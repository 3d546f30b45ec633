"""Would half of the tests have led to the same effect?

The contenders of a round, which were fitted to all tests, are held against each other again on
halves of the conditions.  Nothing is fitted anew: each contender's parameters are solved for on the
half by one linear GLS step, under the contender's own Σ, restricted to these tests.  An effect that
a few conditions alone speak for loses where they are missing.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from jaxtyping import Bool
from scipy.special import ndtri

from sysid.diagnosis.at_once import at_once
from sysid.diagnosis.contenders import LIKE_LAWS, SHAPE, Round
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.plain import INDEPENDENT, NONE, unweighted
from sysid.diagnosis.state import State
from sysid.likelihood.discrepancy import Covariance

HALVES: Final = 50
"""Halves that are looked at: 25 random cuts, both sides of each."""
STEADY: Final = 0.8
"""Share of halves that must come to the same name or class.  Where Σ was not fitted it is told but
not asked for: a likelihood that only counts errors says little about halves."""
FEWEST: Final = 6
"""Conditions below which halves are too small to hold a model."""


def has_halves(evidence: Evidence) -> bool:
    """There are conditions enough for halves that hold a model."""
    return np.unique(evidence.condition).size >= FEWEST


def wins(evidence: Evidence, one: Round, seed: int = 0) -> dict[str, float]:
    """Share of half-samples of conditions in which each contender of a round comes first.

    A contender wins a half if it gains most there, and as much as an effect that just suffices on
    all tests, and speaks from all alike, gains in `STEADY` of the halves; so shares may add up to
    less than one.  Empty with too few conditions.

    Args:
        evidence: The campaign.
        one: The round.
        seed: Of the halves.
    """
    if not has_halves(evidence) or not one.contenders:
        return {}
    plain = one.before.sizes == NONE
    whole = unweighted(evidence) if plain else evidence
    least = 0.0 if plain else least_of_half(one.contenders[0].least)
    extra = np.array([c.state.u.size - one.before.u.size - 1 for c in one.contenders])
    count = dict.fromkeys((c.id for c in one.contenders), 0)
    states = (one.before, *(c.state for c in one.contenders))
    halves = _halves(evidence.ordered_condition, seed)
    for likelihood in at_once(lambda half: _likelihoods(whole, states, half), halves):
        gain = likelihood[1:] - likelihood[0] - SHAPE * extra
        first = int(np.argmax(gain))
        if gain[first] > least:
            count[one.contenders[first].id] += 1
    return {id: n / HALVES for id, n in count.items()}


def least_of_half(least: float) -> float:
    r"""Log-likelihood that an effect gains in all but 1 − `STEADY` of the halves.

    On all tests it gains `least` = x²/2.  On a half that is chosen at random the same noise gives
    x/√2 ± 1/√2 (half of the information, and a quarter of its variance left to chance), so (x −
    z)²/4 with z the quantile of `STEADY`.

    Args:
        least: Log-likelihood.
    """
    return 0.25 * max(float(np.sqrt(2.0 * least)) - float(ndtri(STEADY)), 0.0) ** 2


def stability(
    evidence: Evidence, one: Round, members: Sequence[str], kept: Sequence[str] = ()
) -> float:
    """Share of halves of the conditions in which a round comes to one of these ids; NaN if unknown.

    Changes of the laws take no part unless they are asserted: part of every error of the laws
    looks like one of them, and whether it is most of it (`selection.OF_LAWS`) needs a fit.  Nor do
    other effects of the final model: it holds them beside what is asserted, not instead of it, and
    which of two comes first says nothing.

    Args:
        evidence: The campaign.
        one: The round.
        members: Of the name or class that is asserted.
        kept: Effects of the final model.
    """
    others = tuple(
        c
        for c in one.contenders
        if c.id in members or (c.id not in kept and c.scored.effect.facts.family not in LIKE_LAWS)
    )
    found = wins(evidence, replace(one, contenders=others))
    return sum(found.get(m, 0.0) for m in members) if found else float("nan")


def _halves(condition: np.ndarray, seed: int) -> Iterator[Bool[np.ndarray, " loop"]]:
    """Tests of one half of the conditions, then those of the other; again for the next cut."""
    rng = np.random.default_rng(seed)
    count = int(condition.max()) + 1
    for _ in range(HALVES // 2):
        half = np.isin(condition, rng.permutation(count)[: count // 2])
        yield half
        yield ~half


def _likelihoods(
    evidence: Evidence, states: tuple[State, ...], half: Bool[np.ndarray, " loop"]
) -> np.ndarray:
    """Log-likelihood of some tests under each model, its parameters solved for on them."""
    parts = evidence.parts.of(half)
    found = []
    for state in states:
        covariance = Covariance(parts, state.sizes)
        cost = _least_cost(state, covariance, half)
        if state.sizes == NONE:
            tests = int(half.sum())
            found.append(-0.5 * INDEPENDENT * tests * np.log(max(cost, 1e-300) / tests))
        else:
            found.append(-0.5 * (covariance.log_determinant + cost))
    return np.array(found)


def _least_cost(state: State, covariance: Covariance, half: Bool[np.ndarray, " loop"]) -> float:
    """Min over δ of ‖r − Jδ‖² under Σ⁻¹, r and J at the fit to all tests."""
    jacobian, residual = state.gls.jacobian[half], state.gls.residual[half]
    both = np.concatenate([jacobian, residual[:, :, None]], axis=2)
    gram = covariance.inner(both, both)
    information, slope = gram[:-1, :-1], gram[:-1, -1]
    scale = np.sqrt(np.maximum(np.diagonal(information), 1e-300))
    step = np.linalg.lstsq(information / np.outer(scale, scale), slope / scale, rcond=1e-10)[0]
    return float(gram[-1, -1] - step @ (slope / scale))
