"""Small campaigns of one shape, that of tests/diagnosis: everything is compiled once."""

from dataclasses import replace

from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import Trial, make_trial
from sysid.rig.trial_design import TrialDesign
from sysid.trials.regimes import TrialSpec

SMALL = TrialDesign(fewest=60, most=60)


def small_trial(seed: int, *names: str, percent: float = 1.0, **design: float) -> Trial:
    planters = tuple(find_planter(name) for name in names)
    return make_trial(seed, planters, (percent,) * len(planters), replace(SMALL, **design))  # type: ignore[arg-type]  # numbers only


def small_spec(
    regime: str,
    seed: int,
    *names: str,
    percent: float = 1.0,
    misfit: float = 0.0,
    model: str = "w11",
) -> TrialSpec:
    design = replace(SMALL, model=model)  # type: ignore[arg-type]  # a literal
    return TrialSpec(regime, seed, names, (percent,) * len(names), misfit, design)
