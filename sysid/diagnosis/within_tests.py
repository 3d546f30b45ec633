r"""What changes from cycle to cycle within tests: effects that the mean over cycles hides.

Every cycle's force minus the mean over its test is held against what each effect that needs the
cycles would make of it, in one score test over all tests, with noise, drifts of gain and zero of
random sign, and the stroke that each cycle really had taken into account (`cycle_fit`).  What
passes is fitted with its shape parameter by likelihood.  It is an effect if it is far more probable
than changes that no effect makes (`decoys`) and if conditions that were left out confirm it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.special import chdtri

from sysid.diagnosis.cycle_candidates import Candidate, candidates, decoys, followed, with_values
from sysid.diagnosis.cycle_evidence import CycleEvidence, gather_cycles
from sysid.diagnosis.cycle_fit import Fitted, fit_change, inner
from sysid.diagnosis.cycle_race import STEP, Raced, race
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.ladder import APART, CAP, LEAST_EVIDENCE, UNSURE
from sysid.diagnosis.quantities import quantity_of
from sysid.diagnosis.result import Quantity, ScreenRow
from sysid.diagnosis.scores import FALSE_ALARM
from sysid.diagnosis.stability import HALVES, STEADY
from sysid.effects.base import AbstractEffect
from sysid.models.base import AbstractValve
from sysid.parameters import specs

CONFIRMED: Final = 0.5
"""Part of what an effect gains that conditions must gain by the size found on the others: noise and
single tests give nothing."""
FEWEST_TESTS: Final = 6
"""Tests of three cycles or more below which nothing can be confirmed on others."""


@dataclass(frozen=True)
class Within:
    """What the cycles say.

    Attributes:
        screen: Of every candidate.
        effect: The best member as identified; None where nothing is asserted.
        members: Ids that remain possible, the best first.
        parameters: Of the effect.
        gain: Log-likelihood that it gains.
        behind: By how much the next best, effect or decoy, gains less.
        confidence: That the cause is among the members.
        stability: Share of halves of the conditions that come to one of the members.
        tests: That had cycles enough.
        unnamed: What changes instead, where no effect of the catalogue explains it; else None.
    """

    screen: tuple[ScreenRow, ...] = ()
    effect: AbstractEffect | None = None
    members: tuple[str, ...] = ()
    parameters: tuple[Quantity, ...] = ()
    gain: float = 0.0
    behind: float = 0.0
    confidence: float = 0.0
    stability: float = float("nan")
    tests: int = 0
    unnamed: str | None = None


def look_within(evidence: Evidence, valve: AbstractValve, seed: int = 0) -> Within:
    """Look for effects in the cycles of the tests.

    Args:
        evidence: The campaign.
        valve: The base model, fitted.
        seed: Of the halves.
    """
    cycles = gather_cycles(evidence.loops, evidence.basis, evidence.condition)
    if cycles is None or cycles.tests.size < FEWEST_TESTS:
        return Within(tests=0 if cycles is None else int(cycles.tests.size))
    cycles = followed(evidence, cycles, valve)
    null = fit_change(cycles)
    known = candidates(evidence, cycles, valve)
    threshold = float(chdtri(1, FALSE_ALARM / sum(len(c.shapes) for c in known)))
    screen = tuple(_screened(cycles, null, c, threshold) for c in known)
    passed = [c for c, row in zip(known, screen, strict=True) if row.score > threshold]
    tests = int(cycles.tests.size)
    if not passed:
        return Within(screen, tests=tests)
    others = decoys(evidence, cycles, valve)
    raced = sorted(
        (race(cycles, null, c) for c in (*passed, *others)), key=lambda r: r.gain, reverse=True
    )
    return _decided(cycles, null, raced, screen, threshold, seed)


def _screened(
    cycles: CycleEvidence, null: Fitted, candidate: Candidate, threshold: float
) -> ScreenRow:
    """Score test of a candidate at its best shape."""
    rows = []
    for shape in candidate.shapes:
        x = candidate.change(shape, candidate.nominal) / candidate.nominal
        along = float(inner(cycles, null.scatter, x, cycles.change).sum())
        square = float(inner(cycles, null.scatter, x, x).sum())
        noise = null.scatter.noise[:, None] * np.sqrt(null.scatter.spectrum)
        plain = float(np.sum((x / noise[:, None, :]) ** 2))
        score = along**2 / max(square, 1e-300) if along > 0.0 or not candidate.signed else 0.0
        rows.append((score, square, plain, along))
    score, square, plain, along = max(rows)
    return ScreenRow(
        id=candidate.id,
        score=score,
        threshold=threshold,
        survival=square / max(plain, 1e-300),
        expected_change=along / max(square, 1e-300),
        se=float(1.0 / np.sqrt(max(square, 1e-300))),
    )


def _decided(
    cycles: CycleEvidence,
    null: Fitted,
    raced: Sequence[Raced],
    screen: tuple[ScreenRow, ...],
    threshold: float,
    seed: int,
) -> Within:
    """What may be asserted of candidates that were fitted, best first."""
    tests = int(cycles.tests.size)
    best = raced[0]
    if best.gain < 0.5 * threshold:
        return Within(screen, tests=tests)
    rivals = [r for r in raced[1:] if not _excluded(cycles, null, best, r)]
    if best.candidate.effect is None or any(r.candidate.effect is None for r in rivals):
        decoy = next(r for r in raced if r.candidate.effect is None)
        sure = _confirmed(cycles, decoy) >= CONFIRMED
        return Within(screen, tests=tests, unnamed=decoy.candidate.id if sure else None)
    if _confirmed(cycles, best) < CONFIRMED:
        return Within(screen, tests=tests)
    members = (best.candidate.id, *(r.candidate.id for r in rivals))
    steady = _stability(cycles, null, raced, members, seed)
    if steady < STEADY:
        return Within(screen, tests=tests)
    behind = best.gain - max([0.0, *(r.gain for r in raced[1:] if r not in rivals)])
    confidence = CAP * (1.0 - float(np.exp(-0.25 * behind)))
    if confidence < UNSURE:
        return Within(screen, tests=tests)
    quantities = _quantities(cycles, best)
    values = {q.symbol: q.value for q in quantities}
    return Within(
        screen=screen,
        effect=with_values(best.candidate.effect, values),
        members=members,
        parameters=quantities,
        gain=best.gain,
        behind=behind,
        confidence=round(confidence, 3),
        stability=steady,
        tests=tests,
    )


def _excluded(cycles: CycleEvidence, null: Fitted, best: Raced, rival: Raced) -> bool:
    """The rival is less likely by many of the distances between their predictions.

    Distances are in standard errors without either: with the best one they grow in proportion to a
    strong effect, but log-likelihoods, of a scatter that is itself fitted, only as its logarithm.
    """
    apart = best.change - rival.change
    distance = np.sqrt(inner(cycles, null.scatter, apart, apart).sum())
    return bool(best.gain - rival.gain > max(LEAST_EVIDENCE, APART * float(distance)))


def _by_condition(cycles: CycleEvidence, per_test: np.ndarray) -> np.ndarray:
    numbers = np.unique(cycles.condition)
    return np.stack([per_test[cycles.condition == c].sum(axis=0) for c in numbers])


def _confirmed(cycles: CycleEvidence, best: Raced) -> float:
    """Log-likelihood that conditions gain by the size found on the others, as a share of all."""
    along, square = (_by_condition(cycles, z) for z in (best.fitted.along, best.fitted.square))
    others = (along.sum() - along) / np.maximum(square.sum() - square, 1e-300)
    others = np.maximum(others, 0.0) if best.candidate.signed else others
    gain = others * along - 0.5 * others**2 * square
    return float(gain.sum() / max(0.5 * along.sum() ** 2 / square.sum(), 1e-300))


def _stability(
    cycles: CycleEvidence,
    null: Fitted,
    raced: Sequence[Raced],
    members: Sequence[str],
    seed: int,
) -> float:
    """Share of random halves of the conditions in which a member scores highest."""
    scores = []
    for r in raced:
        x = r.change / (r.fitted.size or 1.0)
        along = _by_condition(cycles, inner(cycles, null.scatter, x, cycles.change))
        square = _by_condition(cycles, inner(cycles, null.scatter, x, x))
        scores.append((along, square, r.candidate.signed))
    count = scores[0][0].size
    random, won = np.random.default_rng(seed), 0
    for _ in range(HALVES // 2):
        order = random.permutation(count)
        for half in (order[: count // 2], order[count // 2 :]):
            each = [
                (max(a[half].sum(), 0.0) if signed else a[half].sum()) ** 2
                / max(b[half].sum(), 1e-300)
                for a, b, signed in scores
            ]
            won += raced[int(np.argmax(each))].candidate.id in members
    return won / (HALVES // 2 * 2)


def _quantities(cycles: CycleEvidence, best: Raced) -> tuple[Quantity, ...]:
    """Size and shape with intervals: the larger of the model's and the scatter over conditions."""
    effect, candidate, fitted = best.candidate.effect, best.candidate, best.fitted
    assert effect is not None
    up, down = (candidate.change(best.shape * float(np.exp(z)), fitted.size) for z in (STEP, -STEP))
    directions = (best.slope, (up - down) / (2.0 * STEP))
    left = cycles.change - best.change
    information = np.array(
        [[inner(cycles, fitted.scatter, a, b).sum() for b in directions] for a in directions]
    )
    slopes = _by_condition(
        cycles, np.stack([inner(cycles, fitted.scatter, a, left) for a in directions], axis=1)
    )
    inverse = np.linalg.pinv(information, rcond=1e-10, hermitian=True)
    sandwich = inverse @ (slopes.T @ slopes) @ inverse
    sd = np.sqrt(np.maximum(np.diagonal(inverse), np.diagonal(sandwich)))
    return _stated(effect, best, sd)


def _stated(
    effect: AbstractEffect, best: Raced, sd: Float[np.ndarray, " two"]
) -> tuple[Quantity, ...]:
    size = {effect.facts.size: (best.fitted.size, float(sd[0]))}
    both = size | {best.candidate.symbol: (best.shape, float(best.shape * sd[1]))}
    return tuple(quantity_of(s, *both[s.symbol]) for s in specs(effect))
