"""Campaigns of the virtual rig that intervals are studied on: 110 tests, laws right or wrong."""

from dataclasses import replace
from typing import Final

from sysid.identification.fit import fit_loops
from sysid.identification.result import Fit
from sysid.rig.trial_campaign import Trial, make_trial
from sysid.rig.trial_design import TrialDesign
from sysid.trials.misfit import misfit_of
from sysid.trials.program import fingerprint

BANDS: Final = tuple(
    f"uncertainty/{name}.py"
    for name in ("bands", "conformal", "left_out", "loop_bands", "quantities")
)
"""What of the package tells of forces, which no interval of a parameter depends on."""
PROGRAM: Final = fingerprint(
    ("arrays.py", "data", "effects", "identification", "likelihood", "models", "motion",
     "parameters.py", "rig", "trials/misfit.py", "uncertainty", "units.py"),
    ("rig/physical", *BANDS),
)  # fmt: skip
"""Rows count for the program that fitted and told the intervals."""


def fitted(seed: int, percent: float) -> tuple[Trial, Fit, TrialDesign]:
    """A campaign, its fit, and its design, with the size of the errors of the laws.

    Args:
        seed: Of the campaign.
        percent: RMS that the refitted model leaves of a perfect measurement, % of the RMS force.
    """
    design = TrialDesign(fewest=110, most=110)
    design = replace(design, misfit=misfit_of(seed, percent, design).size)
    trial = make_trial(seed, design=design)
    return trial, fit_loops(trial.loops, variant="symmetric"), design
