"""What is kept of a trial: one flat record, as it goes into a file, and how to run one."""

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Protocol

import numpy as np
from pydantic import TypeAdapter

from sysid.data.loops import Loops
from sysid.diagnosis.bases import fit_bases
from sysid.diagnosis.result import Cause, Diagnosis
from sysid.errors import SysidError
from sysid.identification.fit import fit_loops
from sysid.identification.result import Fit
from sysid.motion.history import RunHistory
from sysid.rig.trial_campaign import Trial, make_trial
from sysid.trials.misfit import BASE, misfit_of
from sysid.trials.quantities import TrueQuantity, true_quantities
from sysid.trials.regimes import TrialSpec
from sysid.trials.score import RIGHT, Given, Score, given_by, score
from sysid.trials.visible import Visibility, visibilities


class Diagnose(Protocol):
    """What a diagnosis is given in a trial: loops and their order, never the truth."""

    def __call__(self, loops: Loops, *, history: RunHistory | None, seed: int) -> Diagnosis:
        """Diagnose a campaign."""
        ...


Baseline = Callable[[Fit, Loops], tuple[Given, ...]]
"""Another way to names, from a fitted base model and its loops."""


@dataclass(frozen=True)
class Recovered:
    """A parameter of an effect that was rightly named, beside its true value.

    Attributes:
        id: Of the effect.
        symbol: Of the parameter.
        true: SI.
        value: As identified.
        low: Lower end of its interval.
        high: Upper end.
        exact: The planter follows the effect's law, so that the interval should cover.
        identified: The diagnosis says that the data determine it.
    """

    id: str
    symbol: str
    true: float
    value: float
    low: float
    high: float
    exact: bool
    identified: bool


@dataclass(frozen=True)
class Row:
    """One finished trial.

    Attributes:
        regime: Name.
        seed: Of the campaign.
        loops: Tests in it.
        planters: Names of what was hidden.
        causes: Ids in the catalogue.
        percents: Sizes reached, % of the RMS force.
        misfit: Structural misfit of the refitted base as it turned out, %.
        visibility: One a planter; empty where nothing was hidden or the base has another law.
        answer: Of the diagnosis.
        base: Model and variant that it chose.
        admissible: That base is good enough, as the diagnosis says.
        listed_invisible: A planted effect is among those said to be invisible.
        score: By the rules.
        sizes: RMS force that rightly named effects add, over that of the planted ones; None where
            something was missed or nothing planted.
        recovered: Parameters.
        before: Held-out error of the base, % of max|F|.
        gain: Held-out error before − after, %; 0 where nothing was added.
        oracle_gain: Held-out error before − held-out error of the right base on the loops without
            the planted effects, %; None where nothing was hidden.
        seconds: Of the diagnosis.
        preparation: Of making the campaign, s.
        baseline: Score of the baseline; None where none was asked.
        failure: Why there is no answer.  None in a campaign that was made counts as nothing named;
            of one that could not be made the other fields are empty.
    """

    regime: str
    seed: int
    loops: int
    planters: tuple[str, ...]
    causes: tuple[str, ...]
    percents: tuple[float, ...]
    misfit: float
    visibility: tuple[Visibility, ...] = ()
    answer: str = ""
    base: str = ""
    admissible: bool = True
    listed_invisible: bool = False
    score: Score | None = None
    sizes: float | None = None
    recovered: tuple[Recovered, ...] = ()
    before: float = 0.0
    gain: float = 0.0
    oracle_gain: float | None = None
    seconds: float = 0.0
    preparation: float = 0.0
    baseline: Score | None = None
    failure: str | None = None

    @property
    def visible(self) -> bool:
        """Every planted effect could be named in this campaign."""
        return bool(self.visibility) and all(v.visible for v in self.visibility)

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)


def run_trial(spec: TrialSpec, diagnose: Diagnose, baseline: Baseline | None = None) -> Row:
    """Hide, diagnose, and only then open the truth and score.

    Args:
        spec: The trial.
        diagnose: Gets the loops and what was run before each.
        baseline: Scored beside it, on the same loops.
    """
    begin = time.perf_counter()
    row = Row(spec.regime, spec.seed, 0, spec.planters, (), (), 0.0)
    try:
        misfit = misfit_of(spec.seed, spec.misfit, spec.design)
        design = replace(spec.design, misfit=misfit.size)
        trial = make_trial(spec.seed, spec.hidden, spec.percents or None, design)
    except SysidError as error:
        return replace(row, failure=f"cannot be prepared: {error}")
    prepared = time.perf_counter()
    row = replace(
        row,
        loops=len(trial.loops.ids),
        causes=trial.truth.causes,
        percents=trial.truth.sizes,
        misfit=misfit.percent,
        preparation=prepared - begin,
    )
    try:
        answer = diagnose(trial.loops, history=trial.history, seed=spec.seed)
    except SysidError as error:
        row = replace(row, failure=f"no answer: {error}", score=score((), trial.truth))
    else:
        row = replace(row, seconds=time.perf_counter() - prepared, **_answered(trial, answer))
    if design.model != "w11":
        return row
    base = fit_loops(trial.loops, variant=BASE)
    if trial.truth.planters:
        left = misfit.left if spec.misfit else None
        row = replace(row, visibility=visibilities(trial, spec.seed, design, base, left))
        row = replace(row, oracle_gain=_oracle_gain(trial, row))
    if baseline is not None:
        row = replace(row, baseline=score(baseline(base, trial.loops), trial.truth))
    return row


def _answered(trial: Trial, answer: Diagnosis) -> dict[str, Any]:
    """What an answer adds to a row."""
    gain, truth = answer.gain, trial.truth
    judged = score(given_by(answer), truth)
    right = [
        (cause, j.cause)
        for cause, j in zip(answer.causes, judged.judged, strict=True)
        if j.verdict in RIGHT
    ]
    return {
        "answer": answer.answer,
        "base": f"{answer.base.model} {answer.base.variant}",
        "admissible": answer.base.admissible,
        "listed_invisible": any(e.id in truth.causes for e in answer.invisible),
        "score": judged,
        "sizes": _sizes(trial, [cause for cause, _ in right]) if judged.all_found else None,
        "recovered": _recovered(true_quantities(trial), [cause for cause, _ in right]),
        "before": 100.0 * answer.base.held_out_nrmse,
        "gain": 0.0 if gain is None else 100.0 * (gain.before - gain.after),
    }


def _sizes(trial: Trial, right: Sequence[Cause]) -> float | None:
    """RMS force that the names add over RMS force that was planted; one name only."""
    if len(right) != 1:
        return None
    added = trial.truth.force - trial.truth.force_without
    return right[0].extra_error / float(np.sqrt(np.mean(added**2)))


def _recovered(true: Sequence[TrueQuantity], right: Sequence[Cause]) -> tuple[Recovered, ...]:
    """Identified values beside true ones, for names whose effect is the planted one."""
    return tuple(
        Recovered(q.id, q.symbol, q.value, p.value, p.low, p.high, q.exact, p.identified)
        for cause in right
        for q in true
        if q.of(cause.effect)
        for p in cause.parameters
        if p.symbol == q.symbol
    )


def _oracle_gain(trial: Trial, row: Row) -> float:
    """Gain of knowing the planted force exactly, % of max|F|, mean over tests.

    After: the base fitted to the loops less the planted force, errors and noise of the rig left
    in, every condition predicted without it.  Before: the same of the base that was diagnosed.
    """
    truth, loops = trial.truth, trial.loops
    free = replace(loops, force=loops.force - (truth.force - truth.force_without))
    known = fit_bases(free, [("generalized", BASE)], seed=row.seed, progress=lambda _: None)[0]
    peak = np.abs(loops.force).max(axis=1)
    return row.before - 100.0 * float(np.mean(known.held_out * known.evidence.peak / peak))


def read_row(values: dict[str, Any]) -> Row:
    """A row from what `Row.as_dict` gave, by way of JSON."""
    return TypeAdapter(Row).validate_python(values)
