"""Heat balance and the operator who brings the damper to temperature."""

import jax.numpy as jnp
import pytest

from sysid.rig.physical.heat import HeatBalance
from sysid.rig.physical.warming import Operator

HEAT = HeatBalance(oil=260.0, body=250.0, inner=15.0, outer=0.6, room=22.0, thermocouple=1.5)


def test_in_steady_state_all_power_passes_through_both_resistances():
    body = 22.0 + 30.0 / 0.6
    oil = body + 30.0 / 15.0
    rates = HEAT.rates(jnp.asarray(30.0), jnp.asarray(oil), jnp.asarray(body))
    assert [float(rate) for rate in rates] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_what_does_not_pass_is_stored():
    oil_rate, body_rate = HEAT.rates(jnp.asarray(200.0), jnp.asarray(50.0), jnp.asarray(40.0))
    stored = 260.0 * float(oil_rate) + 250.0 * float(body_rate)
    assert stored == pytest.approx(200.0 - 0.6 * 18.0, rel=1e-12)


def test_worked_warm_the_oil_is_ahead_by_what_heats_the_body():
    """Far from equilibrium both rise alike: oil − body = (m_b c Ṫ + loss)/inner."""
    oil, body = Operator(power=50.0).bring(HEAT, 22.0, 22.0, 60.0)
    assert body == pytest.approx(60.0, abs=0.1)
    loss = 0.6 * (body - 22.0)
    ahead = (250.0 * (50.0 - loss) / 510.0 + loss) / 15.0
    assert oil - body == pytest.approx(ahead, rel=0.05)


def test_cooled_by_water_the_body_goes_first():
    oil, body = Operator(power=50.0).bring(HEAT, 60.0, 60.0, 11.0)
    assert body == pytest.approx(11.0, abs=0.1)
    assert 0.5 < oil - body < 8.0


def test_an_operator_who_cannot_reach_it_takes_what_there_is():
    _, body = Operator(power=6.0).bring(HEAT, 22.0, 22.0, 60.0)
    assert body == pytest.approx(32.0, abs=0.5)
