"""Switches of the mechanisms."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.effects.registry import EFFECTS
from sysid.errors import DataError
from sysid.rig.physical.automotive import AUTOMOTIVE
from sysid.rig.physical.mechanisms import MECHANISMS, at_levels, causes_at_work
from sysid.rig.physical.rd1005 import RD_1005

DAMPERS = (AUTOMOTIVE, RD_1005)


def _constants(damper) -> np.ndarray:
    return np.array([float(leaf) for leaf in jax.tree.leaves(damper)])


@pytest.mark.parametrize("mechanism", MECHANISMS, ids=lambda m: m.name)
def test_level_one_is_the_damper_as_built_and_another_is_not(mechanism):
    for damper in DAMPERS:
        own = _constants(damper)
        np.testing.assert_allclose(_constants(mechanism.changed(damper, 1.0)), own, rtol=1e-14)
        raised = _constants(mechanism.changed(damper, 2.0))
        assert 1 <= np.sum(~np.isclose(raised, own, rtol=1e-6, atol=0.0)) <= 3
        assert np.all(np.isfinite(_constants(mechanism.changed(damper, 0.0))))


def test_levels_of_several_mechanisms():
    damper = at_levels(RD_1005, {"play": 3.0, "mount_compliance": 2.0, "stribeck": 0.0})
    assert damper.rig.play == pytest.approx(60e-6)
    assert damper.rig.mount == pytest.approx(1e7)
    assert damper.seal.breakaway == damper.seal.sliding == RD_1005.seal.sliding


def test_thinning_turns_about_the_data_sheets_viscosity():
    thin = at_levels(RD_1005, {"shear_thinning": 2.0}).oil
    assert thin.exponent == pytest.approx(0.8)
    for oil in (thin, RD_1005.oil):
        assert oil.consistency * 1000.0 ** (oil.exponent - 1.0) == pytest.approx(0.112, rel=1e-3)


def test_a_wrong_switch_is_told():
    with pytest.raises(DataError, match="no mechanism 'plai'"):
        at_levels(RD_1005, {"plai": 2.0})
    with pytest.raises(DataError, match="negative"):
        at_levels(RD_1005, {"play": -1.0})


def test_every_mechanism_names_causes_of_the_catalogue():
    known = {effect.facts.id for effect in EFFECTS} | {"waveform_distortion"}
    for mechanism in MECHANISMS:
        assert set(mechanism.causes) <= known, mechanism.name


@pytest.mark.parametrize("damper", DAMPERS, ids=("automotive", "rd1005"))
def test_a_damper_without_any_mechanism_is_still_viscous(damper):
    """So linear viscosity is true of it: force in proportion to speed, 12 η L A²/(w h³)."""
    levels = dict.fromkeys((m.name for m in MECHANISMS if m.name != "coil_lag"), 0.0)
    bare = at_levels(damper, levels)
    valve, area = bare.valve, bare.cylinder.bore - bare.cylinder.rod
    speed = jnp.array([0.05, 0.1, 0.4])
    drop = valve.rest_of_drop(area * speed, bare.oil, jnp.full(3, 40.0))
    newton = 12.0 * 0.112 * valve.passive * area**2 / (valve.width * valve.gap**3)
    np.testing.assert_allclose(area * drop / speed, newton, rtol=2e-3)
    assert newton > 300.0
    assert causes_at_work(levels) >= {"linear_viscosity"}
