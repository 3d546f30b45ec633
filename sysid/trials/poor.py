"""Campaigns that are poor by design, and whether the tests recommended after them settle them.

Tests of one frequency, of two excitations or of one current cannot tell some causes apart.  One
effect is hidden, the campaign is diagnosed, the tests that `advise` recommends are run on the same
damper, and all tests together are diagnosed anew; beside it the same number of tests drawn at
random from those that the limits allow.
"""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Final, Literal, get_args

import jax
import numpy as np
from jaxtyping import Float

from sysid.diagnosis.ladder import CLEARLY
from sysid.diagnosis.questions import Open, Question
from sysid.diagnosis.result import Diagnosis
from sysid.errors import SysidError
from sysid.identification.fit import fit_loops
from sysid.motion.motion import Motion
from sysid.planning.advice import advise
from sysid.planning.candidates import Candidate, Kind, candidates, motion_of, two_cycles
from sysid.planning.discrimination import BASIS, predict_on, weigh
from sysid.planning.limits import Limits
from sysid.planning.words import candidate_words
from sysid.rig.bench import Setting
from sysid.rig.planters.planter import Planter
from sysid.rig.trial_campaign import Trial, make_trial, with_tests
from sysid.rig.trial_design import STANDARD
from sysid.rig.trial_matrix import CURRENTS, settings_below
from sysid.trials.misfit import BASE
from sysid.trials.score import RIGHT, given_by, score
from sysid.trials.visible import DETECTED, visibilities

Poverty = Literal["one_frequency", "two_excitations", "one_current"]
POVERTIES: Final[tuple[Poverty, ...]] = get_args(Poverty)
LIMITS: Final = Limits(
    amplitude=(1e-3, 75e-3), frequency=(0.1, 15.0), velocity=STANDARD.peak_velocity,
    current=CURRENTS,
)  # fmt: skip
"""Of the rig that ran W11's tests, with the velocity of the trials."""
FEWEST_AMPLITUDES: Final = 3
"""Of a campaign at one frequency."""
SIMULATED: Final[tuple[Kind, ...]] = ("sine", "triangle", "rod_disconnected")
"""Kinds of tests that the rig of these campaigns can run."""
Ask = Callable[[Trial], Diagnosis]


@dataclass(frozen=True)
class Settled:
    """What further tests made of the answer.

    Attributes:
        verdict: On the answer to all tests together.
        left: Members of the class that holds the cause, less those that the rig without the
            damper refutes; the cause alone where it is named.
        right: The cause alone is left.
    """

    verdict: str
    left: tuple[str, ...]
    right: bool


@dataclass(frozen=True)
class PoorRow:
    """What became of one poor campaign.

    Attributes:
        poverty: What it lacks.
        seed: Of the campaign.
        planter: What is hidden.
        cause: Id of it.
        percent: Its size as it comes from the factory, % of the RMS force.
        bound: Largest probability with which anyone could name it from these tests.
        detectable: Anyone could see that something is there.
        loops: Tests.
        before: Verdict on the first answer.
        members: Of the class that holds the cause; empty where it was not left open.
        tests: Recommended, in words.
        hopeless: No test within the limits is said to tell the members apart.
        promised: The recommended tests are said to settle it.
        after: What the recommended tests settled; None where none could be run.
        by_chance: The same for as many random ones.
        failure: Why there is no answer.
    """

    poverty: Poverty
    seed: int
    planter: str
    cause: str
    percent: float = 0.0
    bound: float = 0.0
    detectable: bool = False
    loops: int = 0
    before: str = ""
    members: tuple[str, ...] = ()
    tests: tuple[str, ...] = ()
    hopeless: bool = False
    promised: bool = False
    after: "Settled | None" = None
    by_chance: "Settled | None" = None
    failure: str | None = None

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)


def poor_settings(poverty: Poverty, seed: int) -> tuple[Setting, ...]:
    """Tests of a campaign that is poor in one way, out of W11's.

    Args:
        poverty: What it lacks.
        seed: Which of the frequencies, excitations or currents it has.
    """
    random = np.random.default_rng([seed, POVERTIES.index(poverty)])
    every = settings_below(STANDARD.peak_velocity)
    if poverty == "one_current":
        level = random.choice(CURRENTS)
        return tuple(s for s in every if s.current == level)
    conditions = list(dict.fromkeys((s.amplitude, s.frequency) for s in every))
    if poverty == "one_frequency":
        found = [f for _, f in conditions]
        usable = sorted({f for f in found if found.count(f) >= FEWEST_AMPLITUDES})
        one = random.choice(usable)
        return tuple(s for s in every if s.frequency == one)
    pairs = [
        (p, q) for p in conditions for q in conditions if p[0] < q[0] and p[1] != q[1]
    ]  # fmt: skip
    two = pairs[int(random.integers(len(pairs)))]
    return tuple(s for s in every if (s.amplitude, s.frequency) in two)


def run_poor(poverty: Poverty, seed: int, planter: Planter, diagnose: Ask) -> PoorRow:
    """Hide an effect in a poor campaign, diagnose, test what is recommended, diagnose again.

    The effect has its realistic size: scaled to a share of the force, a delay at 0.1 Hz would be
    25 ms.

    Args:
        poverty: What the campaign lacks.
        seed: Of everything random.
        planter: What is hidden.
        diagnose: Gets each campaign, its truth unread.
    """
    row = PoorRow(poverty, seed, planter.name, planter.causes[0])
    try:
        # a damper that is built for all that may be asked for
        design = replace(STANDARD, stroke=LIMITS.amplitude[1])
        trial = make_trial(seed, (planter,), None, design, poor_settings(poverty, seed))
        base = fit_loops(trial.loops, variant=BASE)
        seen = visibilities(trial, seed, design, base)[0]
        row = replace(
            row,
            percent=trial.truth.sizes[0],
            bound=seen.right,
            detectable=seen.distance >= DETECTED,
            loops=len(trial.loops.ids),
        )
        if not row.detectable:
            return row
        answer = diagnose(trial)
        row = replace(row, before=score(given_by(answer), trial.truth).found[0])
        assert answer.open is not None
        question = _asked(answer.open, row.cause)
        return row if question is None else _taken_further(row, trial, question, answer, diagnose)
    except SysidError as error:
        return replace(row, failure=str(error))


def _asked(left: Open, cause: str) -> Question | None:
    """The class that holds the cause."""
    return next((q for q in left.questions if q.kind == "class" and cause in q.about), None)


def _taken_further(
    row: PoorRow, trial: Trial, question: Question, answer: Diagnosis, diagnose: Ask
) -> PoorRow:
    """The recommended tests and as many random ones, each with what it settled."""
    left = answer.open
    assert left is not None
    plan = advise(replace(left, questions=(question,)), LIMITS, STANDARD.temperature)
    tests = [a.test for a in plan.tests]
    words = tuple(map(candidate_words, tests))
    row = replace(
        row, members=question.about, tests=words, hopeless=bool(plan.hopeless),
        promised=bool(plan.settled),
    )  # fmt: skip
    if not tests or any(t.kind not in SIMULATED for t in tests):
        return row
    random = np.random.default_rng([row.seed, len(POVERTIES)])
    allowed = candidates(LIMITS, SIMULATED)
    drawn = [allowed[k] for k in random.permutation(len(allowed))[: len(tests)]]
    after, by_chance = (
        _settled(trial, question, left, chosen, diagnose) for chosen in (tests, drawn)
    )
    return replace(row, after=after, by_chance=by_chance)


def _settled(
    trial: Trial,
    question: Question,
    left: Open,
    tests: Sequence[Candidate],
    diagnose: Ask,
) -> Settled:
    """Run tests on the same damper and ask again."""
    cause = trial.truth.causes[0]
    waves = [t for t in tests if t.kind == "sine"]
    if waves:
        again = with_tests(trial, tuple(map(_setting, waves)))
        answer = diagnose(again)
        verdict = score(given_by(answer), again.truth).found[0]
        members = next((c.members for c in answer.causes if cause in c.members), ())
    else:
        verdict, members = "right_class", question.about
    others = [t for t in tests if t.kind != "sine"]
    refuted = {k for t in others for k in _refuted(question, left, t, trial)}
    stay = {one.ids[0] for k, one in enumerate(question.alternatives) if k not in refuted}
    members = tuple(m for m in members if m in stay)
    return Settled(verdict, members, verdict in RIGHT and members == (cause,))


def _setting(test: Candidate) -> Setting:
    return Setting(test.amplitude, test.frequency, test.current, test.kind == "triangle")


def _refuted(question: Question, left: Open, test: Candidate, trial: Trial) -> list[int]:
    """Alternatives that a test refutes which no diagnosis takes: it must speak for itself.

    What was recorded is held against predictions on the motion that the rig made: its corners of a
    triangle are its own.
    """
    alone = test.kind == "rod_disconnected"
    if alone:
        motion, measured = motion_of([test], STANDARD.temperature), _noise_alone(trial, left.noise)
    else:
        motion, measured = _run(trial, _setting(test))
    found = []
    for one in question.alternatives:
        seen = predict_on(one, motion, alone=alone)
        was = replace(seen, harmonics=measured)
        frequency = np.array([test.frequency])
        far = weigh(was, seen, one.covariance, left.sizes, left.noise, frequency).distance()
        found.append(float(far[0]))
    least = min(found)
    enough = np.log(100.0) if alone else CLEARLY
    return [k for k, far in enumerate(found) if far - least >= 2.0 * enough]


def _run(trial: Trial, setting: Setting) -> tuple[Motion, Float[np.ndarray, "1 m"]]:
    """One more test on the damper of a trial: the motion that the rig made, and harmonics, N."""
    loops = with_tests(trial, (setting,)).loops
    motion = two_cycles(
        loops.displacement[-1],
        loops.velocity[-1],
        loops.acceleration[-1],
        float(loops.current[-1]),
        float(loops.temperature[-1]),
        float(loops.frequency[-1]),
    )
    force = loops.force[-1:]
    return jax.tree.map(lambda z: z[None], motion), force @ BASIS.columns / force.shape[1]


def _noise_alone(trial: Trial, noise: float) -> Float[np.ndarray, "1 m"]:
    """Harmonics of a rig without the damper, N.

    Every planted effect acts on the damper, or on what its force becomes in the channel.
    """
    random = np.random.default_rng([trial.seed, len(POVERTIES) + 1])
    return noise * random.normal(size=(1, BASIS.columns.shape[1]))
