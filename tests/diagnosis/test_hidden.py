"""How effects are listed that tests cannot show."""

import numpy as np
import pytest

from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.hidden import hidden
from sysid.diagnosis.scores import Scored
from sysid.diagnosis.within_tests import Within
from sysid.effects.registry import effect_kind, make


def told(evidence: Evidence, survival: float) -> str:
    scored = Scored(
        effect=make(effect_kind("linear_viscosity")),
        signature=np.zeros_like(evidence.measured),
        score=0.0,
        threshold=15.0,
        survival=survival,
        expected=0.0,
        se=1.0,
    )
    found = {z.id: z.because for z in hidden(evidence, (scored,), Within())}
    return found["linear_viscosity"]


@pytest.mark.parametrize("rounding", [0.0, 1e-300, 6.6e-299, 1e-15])
def test_what_survives_by_rounding_is_absorbed_wholly(evidence, rounding):
    assert told(evidence, rounding) == "the base model absorbs it wholly here"


def test_what_hardly_survives_is_told_by_how_much(evidence):
    said = told(evidence, 1.5e-4)
    assert said == "the base model absorbs all but 0.015 % of its signature here"
