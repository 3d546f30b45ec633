"""W11's own puzzle, all tests of the joined sets: two sets were needed for the width."""

import numpy as np
import pytest
from w11_joined import MODEL, SETS, joined, measured, travel_to_zero

from sysid.data.loops import Loops
from sysid.diagnosis.diagnose import diagnose_loops
from sysid.diagnosis.result import Diagnosis
from sysid.effects.law.width_law import WidthLaw


@pytest.fixture(scope="module")
def loops() -> Loops:
    """As many as other diagnoses have, filled up: what is compiled for them serves here."""
    return joined(*(measured(name) for name in SETS))


@pytest.fixture(scope="module")
def found(loops: Loops) -> Diagnosis:
    return diagnose_loops(loops, models=(MODEL,), max_effects=1)


def test_the_measured_travel_is_the_same_in_both_sets(loops):
    """With field, over amplitudes 1 : 5, frequencies 1 : 30 and forces 1 : 4."""
    travel = travel_to_zero(loops.force, loops.displacement)
    for current in (0.2, 0.4):
        here = np.abs(loops.current - current) < 0.02
        assert np.ptp(loops.amplitude[here]) > 9e-3
        np.testing.assert_allclose(travel[here], travel[here].mean(), rtol=0.15)


def test_the_width_law_is_named_and_is_a_constant_travel(found):
    assert found.answer == "named"
    assert [c.id for c in found.causes] == ["width_law"]
    (effect,) = found.damper.effects
    assert isinstance(effect, WidthLaw)
    assert float(effect.p_w) == pytest.approx(0.5, abs=0.1)


def test_one_model_now_serves_both_sets(found):
    """Every condition predicted without it."""
    assert found.gain is not None
    assert found.gain.before > 0.1
    assert found.gain.after < 0.3 * found.gain.before
    travel, truth = (
        travel_to_zero(force, found.loops.displacement)
        for force in (found.simulated_after, found.loops.force)
    )
    field = found.loops.current > 0.1
    np.testing.assert_allclose(travel[field], truth[field], rtol=0.2)


def test_no_rival_remains(found):
    """Nor a spring in series: it would have to be softer than a damper of this travel has."""
    (cause,) = found.causes
    assert cause.members == ("width_law",)
    assert cause.confidence > 0.85
