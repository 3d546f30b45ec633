"""The page of a fit."""

import shlex
from collections.abc import Sequence
from typing import Any

import numpy as np

from sysid.cards.schema import Card
from sysid.data.loops import Loops
from sysid.data.record import Record
from sysid.diagnosis.words import MODEL_WORDS
from sysid.identification.problem import record_motion
from sysid.identification.result import Fit
from sysid.models.simulate import simulate
from sysid.motion.motion import loop_motion
from sysid.report.page.headline import fit_headline
from sysid.report.page.one_test import OneTest, Role, absent_tests, history_test, loop_tests
from sysid.report.page.open_ends import open_after_fit
from sysid.report.page.page import Page, make_page
from sysid.report.page.parameter_table import parameter_table
from sysid.report.page.provenance import Origin, provenance
from sysid.report.page.symmetry import what_is_left
from sysid.uncertainty.estimate import Estimates


def fit_page(
    fit: Fit,
    estimates: Estimates,
    card: Card,
    summary: dict[str, Any],
    loops: Loops,
    others: Sequence[Record],
    origin: Origin,
    distrust: tuple[str, ...] = (),
    title: str | None = None,
) -> Page:
    """Gather the page of a fit.

    Args:
        fit: The fit.
        estimates: Its parameters with the card's intervals.
        card: Its card.
        summary: The content of fit.json, whose numbers the page shows.
        loops: Sinusoidal tests, those held out included.
        others: Tests of other motions, likewise.
        origin: Where the tests come from, and what was typed.
        distrust: Why the fit must not be trusted.
        title: Of the page; the campaign's name if None.
    """
    told = {t["id"]: t for t in summary["tests"]}
    name = MODEL_WORDS.get(fit.model, fit.model)
    tests: list[OneTest] = []
    models = {}
    if loops.ids:
        force = np.asarray(simulate(fit.valve, loop_motion(loops)))
        models = {name: force}
        errors = {i: (_known(told[i]["nrmse"]),) for i in loops.ids}
        tests += loop_tests(loops, (force,), errors, {i: _role(told[i]) for i in loops.ids})
    for record in others:
        motion = record_motion(record)
        entry = told[record.id]
        force = np.asarray(simulate(fit.valve, motion))
        tests.append(
            history_test(record, motion, (force,), (_known(entry["nrmse"]),), _role(entry))
        )
    shown = {t.id for t in tests}
    left_out = {i: t["why_not"] or "not used" for i, t in told.items() if i not in shown}
    tests += absent_tests(left_out, origin.records)
    free = estimates.symbols
    open_ = sum(not p.identified for p in estimates.parameters if p.symbol in free)
    settings = {
        "model": f"{fit.model}, {fit.variant}", "weights": fit.weights,
        "starts": str(fit.starts), "result": fit.result.value,
    }  # fmt: skip
    command = f"sysid diagnose {shlex.quote(origin.folder)} -o diagnosis"
    return make_page(
        title=title or origin.campaign, what="Fit", models=(name,),
        headline=fit_headline(summary, tests, len(free), open_, distrust), tests=tests,
        left=what_is_left(loops, models), parameters=(parameter_table(card),),
        open_ends=open_after_fit(tuple(estimates.undetermined), command),
        provenance=provenance(origin, settings, card, summary["notes"]),
        tolerance=origin.tolerance,
    )  # fmt: skip


def _role(entry: dict[str, Any]) -> Role:
    return "held out" if entry["held_out"] else "fitted"


def _known(value: float | None) -> float:
    return float("nan") if value is None else value
