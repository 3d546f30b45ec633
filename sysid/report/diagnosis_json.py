"""`diagnosis.json`: the answer of a diagnosis, for scripts."""

from collections.abc import Mapping, Sequence
from typing import Any

from sysid.diagnosis.result import Anova, Cause, Diagnosis, Gain, Quantity, Rival, Term
from sysid.diagnosis.sentences import sentences
from sysid.report import diagnosis_schema as schema
from sysid.report.fit_json import known


def diagnosis_json(
    diagnosis: Diagnosis,
    *,
    holdout: Sequence[tuple[str, float, float]] = (),
    left_out: Mapping[str, str] | None = None,
    free_run: tuple[float, float] | None = None,
    distrust: Sequence[str] = (),
    notes: Sequence[str] = (),
) -> dict[str, Any]:
    """A diagnosis as the contract's object; unknown numbers are null.

    Args:
        diagnosis: The diagnosis.
        holdout: (id, error before, error after) of tests that entered no fit, RMSE/max|F|.
        left_out: Id → reason, of tests that were not used.
        free_run: Of the exported card, simulated: mean RMSE/max|F|, and largest deviation from
            `diagnosis.simulated_after` relative to the largest force.
        distrust: Why the answer must not be trusted; empty where it may.
        notes: What is to be said of the tests, besides the diagnosis's own.
    """
    d = diagnosis
    others = [r for r in d.rivals if (r.model, r.variant) != (d.base.model, d.base.variant)]
    whole = schema.DiagnosisJson(
        format=schema.SCHEMA,
        answer=d.answer,
        sentences=d.sentences or sentences(d),
        causes=tuple(_cause(c) for c in d.causes),
        invisible=tuple(
            schema.Invisible(id=z.id, because=z.because, test=z.test) for z in d.invisible
        ),
        unknown=schema.Unknown(
            present=d.unknown.present,
            parity=_known(d.unknown.parity),
            depends_on=d.unknown.depends_on,
            exponents=_known(d.unknown.exponents),
            share_of_reducible=known(d.unknown.share_of_reducible),
            moves=d.unknown.moves,
            because=d.unknown.because,
            anova=None if d.unknown.anova is None else _anova(d.unknown.anova),
            proposal=tuple(_term(t) for t in d.unknown.proposal),
            strange=known(d.unknown.strange),
        ),
        gain=None if d.gain is None else _gain(d.gain),
        screen=tuple(
            schema.Screened(
                id=row.id,
                score=known(row.score),
                threshold=known(row.threshold),
                survival=known(row.survival),
                expected_change=known(row.expected_change),
                se=known(row.se),
            )
            for row in d.screen
        ),
        base=schema.Base(**_rival(d.base), rivals=tuple(schema.Rival(**_rival(r)) for r in others)),
        holdout=tuple(
            schema.HeldOut(id=id, nrmse_before=known(before), nrmse_after=known(after))
            for id, before, after in holdout
        ),
        left_out=dict(left_out or {}),
        free_run=None
        if free_run is None
        else schema.FreeRun(mean_nrmse=known(free_run[0]), largest_deviation=known(free_run[1])),
        trusted=not distrust,
        distrust=tuple(distrust),
        notes=(*d.notes, *notes),
    )
    return whole.model_dump(mode="json", by_alias=True)


def _anova(a: Anova) -> schema.Anova:
    return schema.Anova(
        explained=known(a.explained),
        constant=known(a.constant),
        quantities=tuple(
            schema.Dependence(
                quantity=q.quantity, share=known(q.share), alone=known(q.alone), only=known(q.only)
            )
            for q in a.quantities
        ),
        pairs=tuple(
            schema.Joint(first=p.first, second=p.second, share=known(p.share)) for p in a.pairs
        ),
    )


def _term(t: Term) -> schema.Term:
    return schema.Term(
        formula=t.formula,
        parity=t.parity,
        coefficient=known(t.coefficient),
        unit=t.unit,
        sd=known(t.sd),
        removes=known(t.removes),
        se=known(t.se),
        agreed=known(t.agreed),
    )


def _cause(c: Cause) -> schema.Cause:
    return schema.Cause(
        id=c.id,
        status=c.status,
        members=c.members,
        family=c.family,
        parameters={q.symbol: _parameter(q) for q in c.parameters},
        confidence=known(c.confidence),
        because=c.because,
        separating_test=c.separating_test,
        score=known(c.score),
        share=known(c.share),
        extra_error_N=known(c.extra_error),
        stability=known(c.stability),
        from_cycles=c.from_cycles,
        in_base=c.in_base,
    )


def _parameter(q: Quantity) -> schema.Parameter:
    return schema.Parameter(
        value=known(q.value),
        unit=q.unit,
        low=known(q.low),
        high=known(q.high),
        level=q.level,
        sd=known(q.sd),
        name=q.name,
        identified=q.identified,
    )


def _gain(g: Gain) -> schema.Gain:
    errors = zip(g.held_out, g.per_test_before, g.per_test_after, strict=True)
    return schema.Gain(
        held_out_nrmse_before=known(g.before),
        held_out_nrmse_after=known(g.after),
        noise_floor_nrmse=known(g.floor),
        reducible_explained=known(g.reducible_explained),
        low=known(g.low),
        high=known(g.high),
        held_out=g.held_out,
        repeatability_nrmse=known(g.repeatability),
        tests=tuple(
            schema.TestGain(id=id, nrmse_before=known(float(b)), nrmse_after=known(float(a)))
            for id, b, a in errors
        ),
        extrapolation=tuple(
            schema.Extrapolation(left_out=what, nrmse_before=known(b), nrmse_after=known(a))
            for what, b, a in g.extrapolation
        ),
    )


def _rival(r: Rival) -> dict[str, Any]:
    return {
        "model": r.model,
        "held_out_nrmse": known(r.held_out_nrmse),
        "variant": r.variant,
        "extended_nrmse": known(r.extended_nrmse),
        "admissible": r.admissible,
    }


def _known(values: Mapping[str, float]) -> dict[str, float | None]:
    return {name: known(value) for name, value in values.items()}
