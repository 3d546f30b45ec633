"""The gas between its limits: no exchange of heat, and all of it."""

import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sysid.rig.physical.gas import FREEZING, KAPPA, Accumulator


def _work(heat_time: float, duration: float) -> tuple[float, float]:
    """Work done on the gas from 60 to 50 ml at steady speed, J, and the last temperature, °C."""
    gas = Accumulator(charge=2e6, volume=60e-6, heat_time=heat_time)
    speed = -10e-6 / duration

    def rates(t, y):
        volume = jnp.asarray(60e-6 + speed * t)
        warming = gas.warming(volume, jnp.asarray(speed), jnp.asarray(y[0]), jnp.asarray(20.0))
        return [float(warming), -float(gas.pressure(volume, jnp.asarray(y[0]))) * speed]

    end = solve_ivp(rates, (0.0, duration), [20.0, 0.0], "Radau", rtol=1e-8, atol=1e-8).y[:, -1]
    return float(end[1]), float(end[0])


def test_fast_compression_is_adiabatic():
    work, temperature = _work(heat_time=1e9, duration=0.01)
    expected = 2e6 * 60e-6 / (KAPPA - 1.0) * ((60 / 50) ** (KAPPA - 1.0) - 1.0)
    assert work == pytest.approx(expected, rel=1e-6)
    assert temperature + FREEZING == pytest.approx((20 + FREEZING) * (60 / 50) ** (KAPPA - 1.0))


def test_slow_compression_is_isothermal():
    work, temperature = _work(heat_time=1e-3, duration=100.0)
    assert work == pytest.approx(2e6 * 60e-6 * np.log(60 / 50), rel=1e-5)
    assert temperature == pytest.approx(20.0, abs=1e-2)


def test_the_first_law_closes():
    """Adiabatic work is all in the gas's inner energy."""
    gas = Accumulator(charge=2e6, volume=60e-6, heat_time=1e9)
    work, temperature = _work(heat_time=1e9, duration=0.01)
    assert float(gas.heat_capacity()) * (temperature - 20.0) == pytest.approx(work, rel=1e-6)
