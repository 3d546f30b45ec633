"""One small campaign with its fit and its posterior, for all tests of posteriors."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from sysid.data.loops import Loops
from sysid.identification.fit import fit_loops
from sysid.identification.result import Fit
from sysid.likelihood.observed import observe
from sysid.models.generalized import LOW_SYMMETRIC
from sysid.uncertainty.error_model import ErrorModel, error_model
from sysid.uncertainty.posterior import Posterior
from sysid.uncertainty.prior import Prior, prior_of
from sysid.uncertainty.sample import points_for, sample_posterior
from tests.identification.campaigns import HIGH_DESIGN, LOW_DESIGN, virtual_loops

PASSIVE = {**LOW_SYMMETRIC, "k_2": 0.0, "k_3": 0.0}


@dataclass(frozen=True)
class Made:
    """A campaign at 0 A of the passive model (7 parameters), white noise alone."""

    loops: Loops
    fit: Fit
    errors: ErrorModel
    prior: Prior


@pytest.fixture(scope="session")
def made() -> Made:
    loops = virtual_loops(PASSIVE, LOW_DESIGN + HIGH_DESIGN, (0.0,), noise=0.02, seed=4)
    fit = fit_loops(loops, variant="passive", weights="peak")
    points = points_for(fit.model, loops)
    errors = error_model(fit, observe(loops, points=points), "independent")
    return Made(loops, fit, errors, prior_of(fit.coordinates, errors.u))


@pytest.fixture(scope="session")
def drawn(made: Made, tmp_path_factory) -> tuple[Posterior, Path]:
    """Its posterior, and the folder that the chain grew in."""
    folder = tmp_path_factory.mktemp("chain") / "parts"
    found = sample_posterior(made.fit, made.loops, likelihood="independent", folder=folder)
    assert np.isfinite(found.draws).all()
    return found, folder
