"""Which part of what a model leaves is an error of the valve's laws."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.diagnosis.remainder import lawful
from sysid.likelihood.discrepancy import Sizes
from sysid.likelihood.reml import fit_sizes
from sysid.models.coordinates import valve_at
from tests.likelihood.dense import draw

NONE = Sizes(gain=1e-4, offset=0.1, delay=1e-6)
LAWS_ERR = replace(NONE, scale=0.03, width=0.1)
OTHERWISE = replace(NONE, odd=0.02, even=0.02)


@pytest.mark.parametrize(
    ("sizes", "low", "high"),
    [
        pytest.param(LAWS_ERR, 0.9, 1.0, id="the laws"),
        pytest.param(OTHERWISE, 0.0, 0.3, id="another shape"),
    ],
)
def test_errors_of_the_laws_are_told_from_others(evidence, base_state, sizes, low, high):
    # drawn about the base model's force, so that the laws' directions are the damper's own
    damper = valve_at(base_state.coordinates, jnp.asarray(base_state.u))
    own = evidence.beside(damper, base_state.gls.residual)
    own = replace(own, parts=replace(own.parts, error=np.inf))
    r = draw(own.parts, sizes, seed=3)
    jacobian = base_state.gls.jacobian
    restricted = fit_sizes(own.parts, r, jacobian)
    state = replace(base_state, gls=replace(base_state.gls, residual=r), restricted=restricted)
    assert low <= lawful(own, state) <= high
