"""How effects are listed that tests cannot show."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.hidden import hidden
from sysid.diagnosis.scores import Scored
from sysid.diagnosis.selection import between_tests
from sysid.diagnosis.within_tests import Within
from sysid.effects.registry import effect_kind, make
from sysid.motion.history import run_history


def scored(evidence: Evidence, id: str, survival: float) -> Scored:
    return Scored(
        effect=make(effect_kind(id)),
        signature=np.zeros_like(evidence.measured),
        score=0.0,
        threshold=15.0,
        survival=survival,
        expected=0.0,
        se=1.0,
    )


def told(evidence: Evidence, survival: float) -> str:
    one = scored(evidence, "linear_viscosity", survival)
    found = {z.id: z.because for z in hidden(evidence, (one,), Within())}
    return found["linear_viscosity"]


@pytest.mark.parametrize("rounding", [0.0, 1e-300, 6.6e-299, 1e-15])
def test_what_survives_by_rounding_is_absorbed_wholly(evidence, rounding):
    assert told(evidence, rounding) == "the base model absorbs it wholly here"


def test_what_hardly_survives_is_told_by_how_much(evidence):
    said = told(evidence, 1.5e-4)
    assert said == "the base model absorbs all but 0.015 % of its signature here"


def test_warmer_oil_is_sought_without_an_order_of_tests_where_the_valve_goes_by_temperature(
    evidence,
):
    """There, and nowhere else, what it does to every force follows from the valve's own laws."""
    oil, wear = (make(effect_kind(id)) for id in ("surface_temperature", "run_drift"))
    unordered = replace(evidence, history=None)
    assert between_tests(oil, unordered, thermal=True)
    assert not between_tests(oil, unordered, thermal=False)
    history = run_history(np.arange(evidence.tests), evidence.loops.current)
    assert between_tests(oil, replace(evidence, history=history), thermal=False)
    assert not between_tests(wear, unordered, thermal=True)
    loops = replace(evidence.loops, temperature=np.full(evidence.tests, np.nan))
    assert not between_tests(oil, replace(unordered, loops=loops), thermal=True)


def test_what_was_sought_without_an_order_of_tests_is_not_told_to_need_one(evidence):
    unordered = replace(evidence, history=None)
    one = scored(evidence, "surface_temperature", 0.5)
    assert "surface_temperature" in {z.id for z in hidden(unordered, (), Within())}
    assert "surface_temperature" not in {z.id for z in hidden(unordered, (one,), Within())}
