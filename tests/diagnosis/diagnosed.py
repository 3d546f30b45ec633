"""Campaigns of one shape, diagnosed on one base."""

from sysid.data.loops import Loops
from sysid.diagnosis.diagnose import diagnose_loops
from sysid.diagnosis.result import Diagnosis
from sysid.rig.trial_design import TrialDesign

BASE = (("generalized", "symmetric"),)
DESIGN = TrialDesign(fewest=60, most=60)


def diagnosed(loops: Loops) -> Diagnosis:
    """On one base, to save time."""
    return diagnose_loops(loops, models=BASE)
