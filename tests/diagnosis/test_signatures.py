"""What an effect adds is the same, however little is simulated for it."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.diagnosis.prototypes import prototypes, shape_grid
from sysid.diagnosis.signatures import signatures
from sysid.effects.base import (
    AbstractChannelEffect,
    AbstractForceEffect,
    AbstractLawEffect,
    AbstractMotionEffect,
)
from sysid.models.damper import Damper

STAGES = (
    AbstractMotionEffect,
    AbstractLawEffect,
    AbstractForceEffect,
    AbstractChannelEffect,
)


@pytest.mark.parametrize("stage", STAGES)
def test_a_signature_is_the_difference_of_two_simulations(stage, evidence, base_state):
    """The first three effects of each stage, against the whole signal path with and without."""
    valve = base_state.coordinates.valve(jnp.asarray(base_state.u)).valve
    kinds = [e for e in prototypes(evidence.size, ("loops", "history")) if isinstance(e, stage)][:3]
    effects = [shape_grid(e, evidence.size)[0] for e in kinds]
    assert effects
    found = signatures(evidence, valve, effects)
    assert found.shape == (*evidence.measured.shape, len(effects))
    for k, effect in enumerate(effects):
        symbol = effect.facts.size
        size = float(getattr(effect, symbol))
        none = eqx.tree_at(lambda e, s=symbol: getattr(e, s), effect, jnp.asarray(0.0))
        with_it, without = (
            np.asarray(Damper(valve, (e,)).force(evidence.motion) @ evidence.columns)
            for e in (effect, none)
        )
        expected = ((with_it - without) / size)[: evidence.tests]
        largest = np.abs(expected).max()
        rounding = 1e-12 * evidence.peak.max() / abs(size)
        np.testing.assert_allclose(found[:, :, k], expected, atol=1e-9 * largest + rounding)
    assert np.abs(found).max() > 0.0
