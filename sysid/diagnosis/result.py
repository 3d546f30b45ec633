"""What a diagnosis returns: the answer, and the evidence for it."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Final, Literal, get_args

import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops
from sysid.diagnosis.questions import Open
from sysid.effects.base import AbstractEffect
from sysid.identification.at_odds import AtOdds
from sysid.identification.result import Fit
from sysid.models.damper import Damper

Status = Literal["named", "class", "family"]
Answer = Literal["named", "class", "family", "unknown", "nothing", "base_inadequate"]
ANSWERS: Final[tuple[Answer, ...]] = get_args(Answer)

PerLoop = Float[np.ndarray, " loop"]
Grid = Float[np.ndarray, "loop phase"]


@dataclass(frozen=True)
class Quantity:
    """A parameter of an effect, as identified.

    Attributes:
        symbol: Of the catalogue.
        name: In words.
        value: SI.
        unit: SI.
        sd: Standard deviation.
        low: Lower end of the interval.
        high: Upper end.
        level: Probability of the interval.
        identified: The data determine it.
    """

    symbol: str
    name: str
    value: float
    unit: str
    sd: float
    low: float
    high: float
    level: float = 0.95
    identified: bool = True


@dataclass(frozen=True)
class Cause:
    """One effect that was added to the model, and how surely it is the cause.

    Attributes:
        status: "named", or "class" where rivals cannot be told apart in these tests, or "family".
        id: Of the best member; None for a family.
        members: Ids of the class, the best first; one for a name.
        family: Of the best member.
        effect: As identified.
        parameters: Its parameters.
        confidence: Probability that the name (or class) is right.
        score: χ² by which it lowers the misfit beyond what the base can absorb.
        share: Part of the energy that all effects together remove.
        extra_error: N, RMS over the campaign of the force that it adds.
        because: Evidence, one sentence.
        separating_test: The test that would tell the members apart; None for a name.
        stability: Share of halves of the conditions that come to one of the members; NaN with too
            few conditions.
        from_cycles: Found in what changes from cycle to cycle within tests.
        in_base: Found in a parameter of the base model, which holds it: nothing was added.
    """

    status: Status
    id: str | None
    members: tuple[str, ...]
    family: str
    effect: AbstractEffect
    parameters: tuple[Quantity, ...]
    confidence: float
    score: float
    share: float
    extra_error: float
    because: str
    separating_test: str | None
    stability: float = float("nan")
    from_cycles: bool = False
    in_base: bool = False


def strongest_first(causes: Iterable[Cause]) -> tuple[Cause, ...]:
    """Causes by how much is asserted, then by share.

    Args:
        causes: In any order.
    """
    order = ("named", "class", "family")
    return tuple(sorted(causes, key=lambda c: (order.index(c.status), -c.share)))


@dataclass(frozen=True)
class Invisible:
    """An effect that these tests cannot show: never to be read as absent.

    Attributes:
        id: Of the effect.
        because: One sentence.
        test: The test that would show it.
        absorbed: The base model's parameters imitate it in these tests.
    """

    id: str
    because: str
    test: str
    absorbed: bool = False


@dataclass(frozen=True)
class Dependence:
    """How much of what remains goes with one quantity, on conditions not used to find that out.

    Attributes:
        quantity: "position", "velocity", "acceleration", "current", "temperature" or "frequency".
        share: Of the remaining energy; shares of all quantities add up to what all explain.
        alone: What functions of this quantity alone explain.
        only: What is lost without it: no other quantity can stand in.
    """

    quantity: str
    share: float
    alone: float
    only: float


@dataclass(frozen=True)
class Joint:
    """A pair of quantities that says more together than the sum of a function of each.

    Attributes:
        first: Quantity.
        second: Quantity.
        share: Of the remaining energy, beyond that sum.
    """

    first: str
    second: str
    share: float


@dataclass(frozen=True)
class Anova:
    """With what the remaining error varies.

    Attributes:
        explained: Share of the remaining energy that functions of all quantities, one and two at a
            time, predict on conditions that they were not fitted to.
        constant: Share of a constant force.
        quantities: Strongest first.
        pairs: Strongest first; those that matter.
    """

    explained: float
    constant: float
    quantities: tuple[Dependence, ...]
    pairs: tuple[Joint, ...]


@dataclass(frozen=True)
class Term:
    """A term that would lower what remains: a proposal, never a name.

    Attributes:
        formula: Of x, v, a, i, such as "x|x|".
        parity: "OD", "OC", "ED" or "EC".
        coefficient: SI.
        unit: Of the coefficient.
        sd: Of the coefficient, by leaving conditions out.
        removes: Share of the remaining energy that it removes, beyond the terms before it, on
            conditions for which neither term nor coefficient was chosen.
        se: Standard error of `removes` over conditions.
        agreed: Share of these choices that fell on this same term.
    """

    formula: str
    parity: str
    coefficient: float
    unit: str
    sd: float
    removes: float
    se: float
    agreed: float


@dataclass(frozen=True)
class Unknown:
    """What remains after everything that was named, by its signature.

    Attributes:
        present: More remains than repeatability and rig errors explain.
        share_of_reducible: Part of the reducible error of the base model that remains.
        parity: "OD", "OC", "ED", "EC" → share of the remaining energy.
        exponents: "amplitude", "frequency", "current" → exponent of the remaining RMS.
        depends_on: Names of what it varies with, strongest first.
        moves: Symbol of the base parameter that would have to vary from loop to loop; None where
            no one stands out.
        because: Sentences about it.
        anova: With what it varies, on unseen conditions; None where nothing is present or too few
            conditions were tested.
        proposal: At most two terms that would lower it; empty where none holds on unseen
            conditions.
        strange: Log-likelihood that a random smooth force, of no effect's shape, would gain beside
            the effects that were found; 0 where no covariance was fitted.
    """

    present: bool
    share_of_reducible: float
    parity: dict[str, float]
    exponents: dict[str, float]
    depends_on: tuple[str, ...]
    moves: str | None = None
    because: tuple[str, ...] = ()
    anova: Anova | None = None
    proposal: tuple[Term, ...] = ()
    strange: float = 0.0


@dataclass(frozen=True)
class Gain:
    """What the extension is worth on tests that were not used for fitting it.

    Every test is predicted by a model fitted without its (amplitude, frequency) condition at any
    current; errors are free-run RMSE/max|F|.  Which effects it has was chosen on all tests.

    Attributes:
        before: Mean over tests, base model.
        after: Mean over tests, extended model.
        floor: Mean over tests of the noise of the cycle mean/max|F|; NaN where no test has two
            cycles.
        repeatability: Mean over tests of the cycle-to-cycle scatter/max|F|.
        reducible_explained: (before − after)/(before − floor), a floor that is not known being
            zero; NaN where the floor is no lower.
        low: Lower end of its 95 % interval over conditions; NaN for few of them.
        high: Upper end.
        per_test_before: [L].
        per_test_after: [L].
        held_out: Ids, in the order of the arrays.
        extrapolation: (what was left out, before, after) for the extreme conditions.
    """

    before: float
    after: float
    floor: float
    repeatability: float
    reducible_explained: float
    low: float
    high: float
    per_test_before: PerLoop
    per_test_after: PerLoop
    held_out: tuple[str, ...]
    extrapolation: tuple[tuple[str, float, float], ...] = ()


@dataclass(frozen=True)
class ScreenRow:
    """One effect in the score screen of the base model.

    Attributes:
        id: Of the effect.
        score: χ²₁ without the effect; far from any model, where Σ is not fitted, no more than
            how much of the misfit it would take.
        threshold: What a score must exceed; NaN where Σ is not fitted.
        survival: Share of its signature that base parameters cannot absorb.
        expected_change: Size that the score test expects, in the unit of its size parameter.
        se: Standard error of that; NaN where Σ is not fitted.
    """

    id: str
    score: float
    threshold: float
    survival: float
    expected_change: float
    se: float


@dataclass(frozen=True)
class Rival:
    """A base model that was tried.

    Attributes:
        model: Name in the registry of models.
        variant: Of it.
        held_out_nrmse: Mean over tests, each predicted without its condition; of the base alone.
        extended_nrmse: The same with the effects found on it; NaN where none were looked for.
        admissible: Good enough for a diagnosis.
    """

    model: str
    variant: str
    held_out_nrmse: float
    extended_nrmse: float
    admissible: bool


@dataclass(frozen=True)
class Diagnosis:
    """The whole answer.

    Attributes:
        answer: Strongest status of the causes; without causes "unknown", "nothing" or
            "base_inadequate".
        causes: Strongest first.
        invisible: What these tests cannot show.
        unknown: What remains.
        gain: None where nothing was added.
        screen: All candidates on the base model, best first.
        base: The base that was chosen.
        rivals: All bases, the chosen one among them, best first.
        fit: The base model's fit to all tests.
        base_damper: The base model alone, fitted.
        damper: The base model, fitted again together with all causes.
        symbols: Symbols of all free parameters of `damper` (effects as "id.symbol").
        values: [k] their values, SI, of the fit whose free run errs least; `causes` have those of
            the fit under Σ, which errs less in each value and more in the force.
        covariance: [k, k] of these values.
        interval: How it was found, in words.
        loops: What was diagnosed; without an effect that the cycles of the tests showed.
        simulated_before: [L, J] N, free run of `base_damper`.
        simulated_after: [L, J] N, free run of `damper`.
        sentences: The answer in an engineer's words, most important first.
        notes: What was done to the data, and limits of the answer.
        open: What the tests leave open, for the choice of the next one; None where nobody asked.
        set_aside: Tests that all others contradict: the answer is about the others.
    """

    answer: Answer
    causes: tuple[Cause, ...]
    invisible: tuple[Invisible, ...]
    unknown: Unknown
    gain: Gain | None
    screen: tuple[ScreenRow, ...]
    base: Rival
    rivals: tuple[Rival, ...]
    fit: Fit
    base_damper: Damper
    damper: Damper
    symbols: tuple[str, ...]
    values: Float[np.ndarray, " k"]
    covariance: Float[np.ndarray, "k k"]
    interval: str
    loops: Loops
    simulated_before: Grid
    simulated_after: Grid
    sentences: tuple[str, ...] = ()
    notes: tuple[str, ...] = field(default=())
    open: Open | None = None
    set_aside: AtOdds | None = None
