"""The tests that would settle most of what is open, at most three."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.diagnosis.ladder import CLEARLY, limits_of
from sysid.diagnosis.questions import Alternative, Kind, Open, Question
from sysid.planning.candidates import POINTS, Candidate, batches, candidates
from sysid.planning.candidates import Kind as TestKind
from sysid.planning.discrimination import Seen, distances, predict
from sysid.planning.limits import Limits

MOST: Final = 3
"""Tests that are recommended at most."""
PER_LOG10: Final = 2.0 * np.log(10.0)
"""Δ a unit of the expected log₁₀ Bayes factor."""
WORTH: Final = 0.5
"""Expected log₁₀ Bayes factor from which a test is worth running at all."""
NINE_IN_TEN: Final = 1.2816
"""Standard deviations below the mean, of a normal law."""
SHOWN: Final = 7.5
"""Log-likelihood by which an effect shows itself in a diagnosis that looks for all of them."""
IN_TURN: Final[tuple[tuple[TestKind, ...], ...]] = (
    ("sine",), ("rod_disconnected",), ("triangle", "current_step"),
)  # fmt: skip
"""Kinds of tests, the simplest first: the next ones are tried where these do not settle it."""
AT_ONCE: Final = 64
"""Tests that are simulated at once."""


def surely(least: float) -> float:
    """Expected log₁₀ Bayes factor of tests that nine times in ten say at least so much.

    Where Δ/2 is expected, a log-likelihood ratio scatters by √Δ: Δ/2 − 1.28 √Δ = least.

    Args:
        least: Log-likelihood.
    """
    root = NINE_IN_TEN + np.sqrt(NINE_IN_TEN**2 + 2.0 * least)
    return float(root**2 / PER_LOG10)


DECISIVE: Final[dict[Kind, float]] = {"class": surely(CLEARLY), "invisible": surely(SHOWN)}
"""Expected log₁₀ Bayes factor from which a question is settled: what the diagnosis asks for.  Odds
of a hundred to one, enough if all errors were known, a law that is slightly wrong makes too."""
WITHOUT_LAWS: Final = surely(np.log(100.0))
"""The same of a run without the damper, in which no law can be wrong: those odds."""


@dataclass(frozen=True)
class Expected:
    """What one alternative says of a test.

    Attributes:
        ids: Effects that make it up; empty for the model without any of those in question.
        force: N, where the alternatives differ most.
    """

    ids: tuple[str, ...]
    force: float


@dataclass(frozen=True)
class Pair:
    """How surely a test tells two alternatives apart, whichever of the two is right.

    Attributes:
        first: Number of an alternative.
        second: Of another one.
        log_bayes: Expected log₁₀ Bayes factor; the smaller one of both ways round.
    """

    first: int
    second: int
    log_bayes: float


@dataclass(frozen=True)
class Advice:
    """A test and what it is good for.

    Attributes:
        test: The test.
        about: Ids of the effects in question.
        pairs: What it says of each pair of alternatives.
        phase: rad, of the sine, where the alternatives that it tells apart differ most.
        expected: What each of them says there.
        noise: N, of a point of the cycle mean.
    """

    test: Candidate
    about: tuple[str, ...]
    pairs: tuple[Pair, ...]
    phase: float
    expected: tuple[Expected, ...]
    noise: float

    @property
    def log_bayes(self) -> float:
        """Of the pair that it tells apart best."""
        return max(p.log_bayes for p in self.pairs)


@dataclass(frozen=True)
class Plan:
    """What to test next.

    Attributes:
        tests: Best first.
        settled: Questions that these tests answer.
        better: Those of which they say something, though not enough.
        hopeless: Those that no test within the limits answers.
        waiting: Those that there was no room for.
    """

    tests: tuple[Advice, ...]
    settled: tuple[Question, ...]
    better: tuple[Question, ...]
    hopeless: tuple[Question, ...]
    waiting: tuple[Question, ...]


def advise(asked: Open, limits: Limits, temperature: float, most: int = MOST) -> Plan:
    """Choose tests.

    Args:
        asked: What is open.
        limits: What rig and damper can do.
        temperature: °C at which to test; NaN if unknown.
        most: Tests at most.
    """
    chosen = [(q, _chosen(q, asked, limits, temperature, most)) for q in asked.questions]
    hopeless = tuple(q for q, found in chosen if not found)
    able = [(q, found) for q, found in chosen if found]
    able.sort(key=lambda one: (one[0].kind != "class", len(one[1]), -one[1][0].log_bayes))
    tests: list[Advice] = []
    settled, better, waiting = [], [], []
    for question, found in able:
        taken = found[: most - len(tests)]
        tests += taken
        if not taken:
            waiting.append(question)
        elif _least(taken, DECISIVE[question.kind]) >= 1.0:
            settled.append(question)
        else:
            better.append(question)
    return Plan(tuple(tests), tuple(settled), tuple(better), hopeless, tuple(waiting))


def _least(taken: Sequence[Advice], decisive: float) -> float:
    """How nearly some tests settle the pair that they separate least; from 1 on they do."""
    return float(np.sum([_said(a, decisive) for a in taken], axis=0).min())


def _said(advice: Advice, decisive: float) -> Float[np.ndarray, " pair"]:
    """What a test says of each pair, in parts of what settles it."""
    alone = advice.test.kind == "rod_disconnected"
    enough = min(decisive, WITHOUT_LAWS) if alone else decisive
    return np.array([p.log_bayes for p in advice.pairs]) / enough


def _chosen(
    question: Question, asked: Open, limits: Limits, temperature: float, most: int
) -> tuple[Advice, ...]:
    """Tests for one question; of a further kind only for pairs that those before do not settle."""
    taken: tuple[Advice, ...] = ()
    decisive = DECISIVE[question.kind]
    for kinds in IN_TURN:
        if len(taken) >= most or (taken and _least(taken, decisive) >= 1.0):
            break
        scored = list(_scored(question, asked, limits, temperature, kinds))
        room = most - (kinds is IN_TURN[0] and _silent(scored))
        taken = until_settled(scored, decisive, room, taken)
    return taken


def _silent(scored: Sequence[Advice]) -> bool:
    """Of some pair none of these tests says anything: another kind needs a place."""
    if not scored:
        return False
    says = np.array([[p.log_bayes for p in a.pairs] for a in scored])
    return bool((says.max(axis=0) < WORTH).any())


def until_settled(
    scored: Sequence[Advice], decisive: float, most: int, taken: tuple[Advice, ...] = ()
) -> tuple[Advice, ...]:
    """Tests that together tell all pairs apart, each the one that says most beside those before.

    What is beyond a decision counts for nothing: a test that settles one pair for good is no help
    with another.  None is asked for twice: errors of the laws would be the same again.

    Args:
        scored: Every test that is possible.
        decisive: Expected log₁₀ Bayes factor that settles a pair.
        most: Tests at most.
        taken: Those that are chosen already.
    """
    while scored and len(taken) < most:
        says = np.array([_said(a, decisive) for a in scored])
        said = np.sum([_said(a, decisive) for a in taken], axis=0)
        news = np.minimum(said + says, 1.0) - np.minimum(said, 1.0)
        again = np.array([any(a.test == t.test for t in taken) for a in scored])
        news = np.where((news >= WORTH / decisive) & ~again[:, None], news, 0.0)
        worth = news.sum(axis=1)
        if worth.max() <= 0.0:
            break
        # of tests that say as much the one that says it most surely, then the slowest
        sure = np.where(news > 0.0, says, 0.0).sum(axis=1)
        best = max(
            np.flatnonzero(worth >= worth.max() - 1e-9).tolist(),
            key=lambda k: (float(sure[k]), -_speed(scored[k])),
        )
        taken = (*taken, scored[best])
    return taken


def _speed(advice: Advice) -> float:
    return advice.test.speed


def _scored(
    question: Question,
    asked: Open,
    limits: Limits,
    temperature: float,
    kinds: Sequence[TestKind],
) -> Iterator[Advice]:
    """Every test with what it is expected to say of a question."""
    every = question.alternatives
    pairs = [
        (a, b) for a, b in combinations(range(len(every)), 2) if every[a].ids != every[b].ids
    ]  # fmt: skip
    for tests in batches(candidates(limits, kinds), AT_ONCE):
        seen = [predict(one, tests, temperature) for one in every]
        apart = [_apart(question, seen, a, b, asked, tests) for a, b in pairs]
        for k, test in enumerate(dict.fromkeys(tests)):
            told = tuple(
                Pair(a, b, float(one[k]) / PER_LOG10)
                for (a, b), one in zip(pairs, apart, strict=True)
            )
            yield _advice(question, test, told, k, seen, asked.noise)


def _apart(
    question: Question,
    seen: Sequence[Seen],
    first: int,
    second: int,
    asked: Open,
    tests: Sequence[Candidate],
) -> Float[np.ndarray, " test"]:
    """Δ of a pair, whichever is right; of an effect that is asked for, if it is there."""
    frequency = np.array([t.frequency for t in tests])

    def if_right(right: int, other: int) -> Float[np.ndarray, " test"]:
        covariance = question.alternatives[other].covariance
        return distances(seen[right], seen[other], covariance, asked.sizes, asked.noise, frequency)

    told = if_right(first, second)
    if question.kind == "class":
        told = np.minimum(told, if_right(second, first))
        one, other = question.alternatives[first], question.alternatives[second]
        told[[_too_large(one, other, t) or _too_large(other, one, t) for t in tests]] = 0.0
    return told


def _too_large(one: Alternative, other: Alternative, test: Candidate) -> bool:
    """The stroke is too large for a diagnosis to take one for anything but the other."""
    simpler = {s for e in one.damper.effects for s in limits_of(e, test.amplitude)}
    return bool(simpler & set(other.ids) - set(one.ids))


def _advice(
    question: Question,
    test: Candidate,
    pairs: tuple[Pair, ...],
    place: int,
    seen: Sequence[Seen],
    noise: float,
) -> Advice:
    forces = np.stack([s.force[place] for s in seen])
    best = max(pairs, key=lambda p: p.log_bayes)
    telling = int(np.argmax(np.abs(forces[best.first] - forces[best.second])))
    return Advice(
        test=test,
        about=question.about,
        pairs=pairs,
        phase=2.0 * np.pi * telling / POINTS,
        expected=tuple(
            Expected(one.ids, float(f[telling]))
            for one, f in zip(question.alternatives, forces, strict=True)
        ),
        noise=noise * float(np.sqrt(POINTS)),
    )
