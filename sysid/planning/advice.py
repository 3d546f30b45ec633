"""The tests that would settle most of what is open, at most three."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import combinations
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.diagnosis.ladder import CLEARLY, limits_of
from sysid.diagnosis.questions import Alternative, Kind, Open, Question
from sysid.planning.candidates import POINTS, Candidate, batches, candidates
from sysid.planning.candidates import Kind as TestKind
from sysid.planning.discrimination import Apart, Seen, predict, weigh
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
class Scored:
    """A test that could be run, and what its say is made of.

    Attributes:
        advice: What it is good for by itself.
        apart: Of each pair, for each alternative that may be right; empty where nothing counts.
    """

    advice: Advice
    apart: tuple[tuple[Apart, ...], ...]

    @property
    def says(self) -> Float[np.ndarray, " pair"]:
        """Expected log₁₀ Bayes factor of each pair, of this test by itself."""
        return np.array([p.log_bayes for p in self.advice.pairs])


@dataclass(frozen=True)
class Plan:
    """What to test next.

    Attributes:
        tests: Best first; one that helps with several questions stands once for each.
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
    able.sort(key=lambda one: (one[0].kind != "class", len(one[1]), -one[1][0].advice.log_bayes))
    tests: list[Advice] = []
    settled, better, waiting = [], [], []
    for question, alone in able:
        found = alone
        if tests:  # what is done anyway may help here as well
            done = tuple(dict.fromkeys(a.test for a in tests))
            helping = _helping(question, asked, done, temperature)
            found = _chosen(question, asked, limits, temperature, most - len(done), helping)
        tests += [one.advice for one in found]
        if not found:
            waiting.append(question)
        elif _least(found, DECISIVE[question.kind]) >= 1.0:
            settled.append(question)
        else:
            better.append(question)
    return Plan(tuple(tests), tuple(settled), tuple(better), hopeless, tuple(waiting))


def _helping(
    question: Question, asked: Open, done: Sequence[Candidate], temperature: float
) -> tuple[Scored, ...]:
    """Of tests that are planned already those that say something of a question, too."""
    scored = _scored(question, asked, done, temperature)
    return tuple(one for one in scored if one.advice.log_bayes >= WORTH)


def _least(taken: Sequence[Scored], decisive: float) -> float:
    """How nearly some tests settle the pair that they separate least; from 1 on they do."""
    (parts,) = _parts([()], taken, decisive)
    return float(parts.min())


def _enough(test: Candidate, decisive: float) -> float:
    """Expected log₁₀ Bayes factor that settles a pair in such a test."""
    return min(decisive, WITHOUT_LAWS) if test.kind == "rod_disconnected" else decisive


def _parts(
    scored: Sequence[Sequence[Scored]], taken: Sequence[Scored], decisive: float
) -> Float[np.ndarray, "candidate pair"]:
    """What each of some sets of tests says beside tests that are taken, in parts of what settles.

    One test may need less than another to settle a pair, so parts are added up, and made as much
    smaller as the tests together say less than their sum (`discrimination`).  That they may say
    more does not count: errors of the laws can be the same in all of them.
    """
    found = []
    for more in scored:
        every = [*taken, *more]
        if not every:
            found.append(0.0)
            continue
        says = np.array([one.says for one in every])
        enough = np.array([_enough(one.advice.test, decisive) for one in every])
        added = says.sum(axis=0)
        share = np.divide(_together(every), added, out=np.zeros_like(added), where=added > 0.0)
        found.append((says / enough[:, None]).sum(axis=0) * np.minimum(share, 1.0))
    return np.array(found)


def _together(every: Sequence[Scored]) -> Float[np.ndarray, " pair"]:
    """Expected log₁₀ Bayes factor of tests together, whichever of a pair is right."""
    told = []
    for k, own in enumerate(every[0].apart):
        ways = [[one.apart[k][way] for one in every if one.apart[k]] for way in range(len(own))]
        joined = [reduce(Apart.beside, some) for some in ways if some]
        told.append(min((float(one.distance()) for one in joined), default=0.0) / PER_LOG10)
    return np.array(told)


def _chosen(
    question: Question,
    asked: Open,
    limits: Limits,
    temperature: float,
    most: int,
    helping: tuple[Scored, ...] = (),
) -> tuple[Scored, ...]:
    """Tests for one question, so many beside those that help already; simple kinds first."""
    taken = helping
    decisive = DECISIVE[question.kind]
    for kinds in IN_TURN:
        left = most + len(helping) - len(taken)
        if left <= 0 or (taken and _least(taken, decisive) >= 1.0):
            break
        scored = list(
            _scored(question, asked, candidates(limits, kinds), temperature, limits.force)
        )
        room = left - (kinds is IN_TURN[0] and _silent(scored))
        taken = until_settled(scored, decisive, len(taken) + room, taken)
    return taken


def _silent(scored: Sequence[Scored]) -> bool:
    """Of some pair none of these tests says anything: another kind needs a place."""
    if not scored:
        return False
    return bool((np.array([one.says for one in scored]).max(axis=0) < WORTH).any())


def until_settled(
    scored: Sequence[Scored], decisive: float, most: int, taken: tuple[Scored, ...] = ()
) -> tuple[Scored, ...]:
    """Tests that together tell all pairs apart, each the one that says most beside those before.

    What is beyond a decision counts for nothing: a test that settles one pair for good is no help
    with another.  None is asked for twice: errors of the laws would be the same again.

    Args:
        scored: Every test that is possible.
        decisive: Expected log₁₀ Bayes factor that settles a pair.
        most: Tests at most.
        taken: Those that are chosen already.
    """
    alone = _parts([(one,) for one in scored], (), decisive)
    enough = np.array([_enough(one.advice.test, decisive) for one in scored])
    while scored and len(taken) < most:
        (said,) = _parts([()], taken, decisive) if taken else np.zeros((1, alone.shape[1]))
        both = _parts([(one,) for one in scored], taken, decisive) if taken else alone
        news = np.maximum(np.minimum(both, 1.0) - np.minimum(said, 1.0), 0.0)
        again = np.array([any(z.advice.test == t.advice.test for t in taken) for z in scored])
        worthwhile = (news * enough[:, None] >= WORTH) & ~again[:, None]
        news = np.where(worthwhile, news, 0.0)
        worth = news.sum(axis=1)
        if worth.max() <= 0.0:
            break
        # of tests that say as much the one that says it most surely, then the slowest
        sure = np.where(worthwhile, alone, 0.0).sum(axis=1)
        best = max(
            np.flatnonzero(worth >= worth.max() - 1e-9).tolist(),
            key=lambda k: (float(sure[k]), -scored[k].advice.test.speed),
        )
        taken = (*taken, scored[best])
    return taken


def _scored(
    question: Question,
    asked: Open,
    tests: Sequence[Candidate],
    temperature: float,
    most: float = math.inf,
) -> Iterator[Scored]:
    """What each of some tests is expected to say of a question.

    One in which any of the explanations expects a force of more than `most` newtons is passed over.
    """
    every = question.alternatives
    pairs = [
        (a, b) for a, b in combinations(range(len(every)), 2) if every[a].ids != every[b].ids
    ]  # fmt: skip
    for batch in batches(tests, AT_ONCE):
        seen = [predict(one, batch, temperature) for one in every]
        ways = [_ways(question, seen, a, b, asked, batch) for a, b in pairs]
        alone = [np.min([way.distance() for way in both], axis=0) / PER_LOG10 for both in ways]
        largest = np.max([np.abs(s.force).max(axis=1) for s in seen], axis=0)
        for k, test in enumerate(dict.fromkeys(batch)):
            if largest[k] > most:
                continue
            apart, told = [], []
            for (a, b), both, says in zip(pairs, ways, alone, strict=True):
                one, other = every[a], every[b]
                counts = question.kind != "class" or not (
                    _too_large(one, other, test) or _too_large(other, one, test)
                )
                apart.append(tuple(way.at(k) for way in both) if counts else ())
                told.append(Pair(a, b, float(says[k]) if counts else 0.0))
            advice = _advice(question, test, tuple(told), k, seen, asked.noise)
            yield Scored(advice, tuple(apart))


def _ways(
    question: Question,
    seen: Sequence[Seen],
    first: int,
    second: int,
    asked: Open,
    tests: Sequence[Candidate],
) -> tuple[Apart, ...]:
    """What tests say of a pair, whichever is right; of an effect in question, if it is there."""
    frequency = np.array([t.frequency for t in tests])

    def if_right(right: int, other: int) -> Apart:
        covariance = question.alternatives[other].covariance
        return weigh(seen[right], seen[other], covariance, asked.sizes, asked.noise, frequency)

    told = if_right(first, second)
    return (told, if_right(second, first)) if question.kind == "class" else (told,)


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
