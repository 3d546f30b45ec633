"""A damper that none of the usual bases describes, but one of the last resort does."""

import numpy as np
import pytest

from sysid.data.loops import Loops
from sysid.diagnosis.bases import BASES, LAST_RESORT
from sysid.diagnosis.coarse import COARSE
from sysid.diagnosis.diagnose import diagnose_loops
from sysid.motion.motion import sine_motion
from tests.models.rival_examples import example

NOISE = 4.0
CYCLES = 4
CONDITIONS = (
    (0.0025, 2.5), (0.0025, 5.0), (0.005, 1.5), (0.005, 4.0), (0.0125, 0.5), (0.0125, 1.5),
    (0.0125, 3.0), (0.025, 0.25), (0.025, 1.0), (0.025, 2.0),
)  # fmt: skip


def modified_bouc_wen_loops(points: int = 72) -> Loops:
    """30 tests, with noise and the rig's errors of gain and offset."""
    grid = np.array([(a, f, i) for a, f in CONDITIONS for i in (0.0, 0.2, 0.4)])
    amplitude, frequency, current = grid.T
    count = len(grid)
    motion = sine_motion(amplitude, frequency, current, points=points)
    clean = np.asarray(example("modified_bouc_wen").force(motion))
    rng = np.random.default_rng(0)
    scatter = NOISE * rng.standard_normal((count, CYCLES, points))
    mean = scatter.mean(axis=1)
    gain = 1.0 + 0.006 * rng.standard_normal((count, 1))
    return Loops(
        ids=tuple(f"{1e3 * a:g}mm_{f:g}Hz_{i:g}A" for a, f, i in grid),
        displacement=np.asarray(motion.displacement), velocity=np.asarray(motion.velocity),
        acceleration=np.asarray(motion.acceleration),
        force=gain * clean + mean + 2.0 * rng.standard_normal((count, 1)),
        amplitude=amplitude, frequency=frequency, current=current,
        temperature=np.full(count, 40.0), centre=np.zeros(count),
        cycles=np.full(count, CYCLES), noise_floor=np.full(count, NOISE),
        deviations=tuple(scatter - mean[:, None]),
        displacement_deviations=tuple(np.zeros((count, CYCLES, points))),
        harmonics=np.eye(1, 15)[0] * amplitude[:, None].astype(complex),
    )  # fmt: skip


@pytest.mark.slow
def test_the_diagnosis_switches_to_the_base_that_is_right():
    """Without it, effects would be put on a base that is off by a tenth of the force."""
    lines: list[str] = []
    found = diagnose_loops(modified_bouc_wen_loops(), max_effects=1, progress=lines.append)
    by_model = {r.model: r.held_out_nrmse for r in found.rivals}
    assert ("modified_bouc_wen", None) in LAST_RESORT
    assert min(by_model[model] for model, _ in BASES) > COARSE, "why the last resort was tried"
    assert found.base.model == "modified_bouc_wen"
    assert found.base.held_out_nrmse < 0.02
    assert found.answer == "nothing", found.sentences
    assert found.causes == ()
