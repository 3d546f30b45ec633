"""The page of a diagnosis."""

import shlex
from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from sysid.cards.schema import Card
from sysid.data.loops import Loops
from sysid.diagnosis.result import Diagnosis
from sysid.report.before_after_plot import errors as errors_of
from sysid.report.before_after_plot import extended, measured_words
from sysid.report.page.headline import diagnosis_headline
from sysid.report.page.one_test import Force, OneTest, absent_tests, loop_tests
from sysid.report.page.open_ends import open_after_diagnosis
from sysid.report.page.page import Page, make_page
from sysid.report.page.parameter_table import parameter_table
from sysid.report.page.provenance import Origin, provenance
from sysid.report.page.screened import screened
from sysid.report.page.symmetry import what_is_left

BEFORE, AFTER = "base model", "extended model"
HELD_OUT: Final = ", predicted without its condition (curves: the model fitted to all tests)"
FITTED: Final = ", by the model fitted to all tests"


def diagnosis_page(
    d: Diagnosis,
    card: Card,
    summary: dict[str, Any],
    origin: Origin,
    distrust: tuple[str, ...] = (),
    held: tuple[Loops, Sequence[Force]] | None = None,
) -> Page:
    """Gather the page of a diagnosis.

    Errors are those that diagnosis.json states: of each test predicted without its condition where
    a gain was measured, else of the base model fitted to all tests.

    Args:
        d: The diagnosis.
        card: Of the extended model.
        summary: The content of diagnosis.json, whose numbers the page shows.
        origin: Where the tests come from, and what was typed.
        distrust: Why it must not be trusted.
        held: Tests that entered no fit, and their forces by both models.
    """
    models = {BEFORE: d.simulated_before}
    if extended(d):
        models[AFTER] = d.simulated_after
    count = len(models)
    tests: list[OneTest] = list(
        loop_tests(d.loops, tuple(models.values()), _errors(d, summary, count),
                   dict.fromkeys(d.loops.ids, "fitted"))
    )  # fmt: skip
    if held is not None and held[0].ids:
        told = {h["id"]: (h["nrmse_before"], h["nrmse_after"]) for h in summary["holdout"]}
        errors = {i: [_nan(e) for e in told[i][:count]] for i in held[0].ids}
        tests += loop_tests(
            held[0], tuple(held[1])[:count], errors, dict.fromkeys(held[0].ids, "held out")
        )
    shown = {t.id for t in tests}
    left = {i: why for i, why in summary["left_out"].items() if i not in shown}
    tests += absent_tests(left, origin.records)
    base = summary["base"]
    settings = {
        "base model": f"{base['model']}, {base['variant']}",
        "other bases": ", ".join(
            f"{r['model']}, {r['variant']} ({100 * r['held_out_nrmse']:.2g} %)"
            for r in base["rivals"] if r["held_out_nrmse"] is not None
        ) or "none",
        "effects added": ", ".join(e.id for e in card.effects) or "none",
    }  # fmt: skip
    return make_page(
        title=origin.campaign, what="Diagnosis", measured=measured_words(d), models=tuple(models),
        headline=diagnosis_headline(summary, distrust), tests=tests,
        left=what_is_left(d.loops, models), screen=screened(summary),
        parameters=(parameter_table(card),),
        open_ends=open_after_diagnosis(d, summary, f"sysid next {shlex.quote(origin.output)}"),
        provenance=provenance(origin, settings, card, summary["notes"]),
        tolerance=origin.tolerance, errors_are=FITTED if d.gain is None else HELD_OUT,
    )  # fmt: skip


def _errors(d: Diagnosis, summary: dict[str, Any], count: int) -> dict[str, Sequence[float]]:
    forces = (d.simulated_before, d.simulated_after)[:count]
    by_model = np.stack([errors_of(d, f) for f in forces], axis=1)
    found: dict[str, Sequence[float]] = dict(zip(d.loops.ids, by_model.tolist(), strict=True))
    for t in summary["gain"]["tests"] if summary["gain"] is not None else ():
        found[t["id"]] = [_nan(t["nrmse_before"]), _nan(t["nrmse_after"])][:count]
    return found


def _nan(value: float | None) -> float:
    return float("nan") if value is None else float(value)
