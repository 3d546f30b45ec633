"""Answers made by hand, to be scored."""

import numpy as np

from sysid.data.loops import Loops
from sysid.diagnosis.result import Cause, Diagnosis, Gain, Invisible, Quantity, Rival, Unknown
from sysid.effects.registry import effect_kind, make
from sysid.identification.fit import fit_loops
from sysid.models.damper import Damper
from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import TrialTruth
from sysid.trials.score import Given


def truth_of(*names: str) -> TrialTruth:
    """The truth of a campaign of one loop in which planters of these names are hidden."""
    planters = tuple(find_planter(name) for name in names)
    one = np.ones((1, 4))
    return TrialTruth(
        planters=planters,
        causes=tuple(c for p in planters for c in p.causes),
        families=tuple(p.family for p in planters),
        sizes=(1.0,) * len(planters),
        nominal=tuple(p.nominal() for p in planters),
        parameters={},
        misfit=0.0,
        force=one,
        force_without=one,
        gain=one[:, 0],
        offset=one[:, 0],
        delay=one[:, 0],
    )


def named(id: str, confidence: float = 0.95) -> Given:
    return Given("named", (id,), effect_kind(id).facts.family, confidence, False)


def a_class(*ids: str, separable: bool = True) -> Given:
    return Given("class", ids, effect_kind(ids[0]).facts.family, 0.92, separable)


def a_family(family: str) -> Given:
    return Given("family", (), family, 0.7, False)


def a_cause(
    id: str,
    *,
    members: tuple[str, ...] = (),
    value: float = 1.0,
    width: float = 1.0,
    extra_error: float = 1.0,
    separating_test: str | None = None,
) -> Cause:
    """A named cause (a class where members are given), with the size parameter ± width."""
    effect = make(effect_kind(id), value)
    size = effect.facts.size
    quantity = Quantity(size, "size", value, "SI", width / 2, value - width, value + width)
    return Cause(
        status="class" if members else "named",
        id=id,
        members=members or (id,),
        family=effect.facts.family,
        effect=effect,
        parameters=(quantity,),
        confidence=0.95,
        score=100.0,
        share=0.9,
        extra_error=extra_error,
        because="It was planted.",
        separating_test=separating_test,
    )


def diagnosis(
    loops: Loops,
    causes: tuple[Cause, ...] = (),
    *,
    gain: float = 0.0,
    invisible: tuple[str, ...] = (),
    answer: str | None = None,
) -> Diagnosis:
    """An answer about loops, with the fitted base and a held-out gain (parts of max|F|)."""
    fit = fit_loops(loops, variant="symmetric")
    base = Rival("generalized", "symmetric", 0.02, float("nan"), True)
    errors = np.full(len(loops.ids), 0.02)
    damper = Damper(fit.valve)
    return Diagnosis(
        answer=answer or (causes[0].status if causes else "nothing"),  # type: ignore[arg-type]  # free text in tests
        causes=causes,
        invisible=tuple(Invisible(id, "absorbed", "another test") for id in invisible),
        unknown=Unknown(False, 0.0, {}, {}, ()),
        gain=Gain(0.02, 0.02 - gain, 0.001, 0.002, 0.9, 0.8, 0.95, errors, errors - gain, loops.ids)
        if causes
        else None,
        screen=(),
        base=base,
        rivals=(base,),
        fit=fit,
        base_damper=damper,
        damper=damper,
        symbols=(),
        values=np.zeros(0),
        covariance=np.zeros((0, 0)),
        interval="",
        loops=loops,
        simulated_before=loops.force,
        simulated_after=loops.force,
    )
