"""Diagnosed campaigns that several files share: most of their time is compiling."""

import numpy as np
import pytest

from sysid.diagnosis.evidence import Evidence, gather
from sysid.diagnosis.result import Diagnosis
from sysid.diagnosis.state import State, settle
from sysid.effects.registry import effect_kind, make
from sysid.identification.fit import fit_loops
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import Trial, make_trial
from tests.diagnosis.diagnosed import DESIGN, diagnosed


@pytest.fixture(scope="session")
def spring_trial() -> Trial:
    """A gas chamber that is a spring of 1 % of the force."""
    return make_trial(71, (find_planter("large_gas_chamber"),), (1.0,), DESIGN)


@pytest.fixture(scope="session")
def spring(spring_trial: Trial) -> Diagnosis:
    return diagnosed(spring_trial.loops)


@pytest.fixture(scope="session")
def plain() -> Diagnosis:
    """The same tests of the same damper without any effect."""
    return diagnosed(make_trial(71, (), (), DESIGN).loops)


@pytest.fixture(scope="session")
def evidence(spring_trial: Trial) -> Evidence:
    return gather(spring_trial.loops)


@pytest.fixture(scope="session")
def base_state(evidence: Evidence) -> State:
    """The base model alone."""
    fit = fit_loops(evidence.loops, variant="symmetric", weights="peak")
    return settle(evidence, DamperCoordinates(fit.coordinates, ()), fit.u)


@pytest.fixture(scope="session")
def spring_state(evidence: Evidence, base_state: State) -> State:
    """The base model with a spring."""
    spring = make(effect_kind("gas_spring"))
    extended = DamperCoordinates(base_state.coordinates.valve_coordinates, (spring,))
    return settle(evidence, extended, np.append(base_state.u, 0.3), base_state.covariance)
