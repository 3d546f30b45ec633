"""Every form of every effect around the lumped model, whose spring and mass have a state."""

from functools import cache

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.effects.base import (
    AbstractChannelEffect,
    AbstractDriveEffect,
    AbstractEffect,
    AbstractForceEffect,
)
from sysid.effects.registry import make
from sysid.models.damper import Damper
from sysid.models.lumped import TABLE_1, Lumped
from sysid.motion.history import run_history, with_history
from sysid.motion.motion import Motion, sine_motion
from sysid.motion.time_motion import time_motion
from sysid.parameters import build
from tests.contracts.outcomes import (
    FORM_IDS,
    FORMS,
    Outcome,
    arranged,
    force_of,
    share_off,
    table_of,
)

CONDITIONS = (
    (10.0, 8.0, 0.1, 15.0), (10.0, 8.0, 1.0, 75.0), (10.0, 8.0, 0.4, 45.0), (5.0, 4.0, 0.4, 15.0),
    (5.0, 4.0, 1.0, 30.0), (20.0, 4.0, 0.6, 60.0), (2.5, 8.0, 1.0, 75.0), (50.0, 0.5, 0.2, 20.0),
)  # fmt: skip
"""mm, Hz, A, °C."""
VALVE = build(Lumped, TABLE_1)
UNSEEN = {"coil_lag", "displacement_zero", "width_law"}
"""Nothing at constant current, nor with a valve that knows neither its place nor a width."""

each_form = pytest.mark.parametrize(("kind", "choice"), FORMS, ids=FORM_IDS)


@cache
def loops() -> Motion:
    amplitude, frequency, current, temperature = np.array(CONDITIONS).T
    motion = sine_motion(1e-3 * amplitude, frequency, current, temperature, points=72)
    order = np.arange(len(CONDITIONS), dtype=float)
    return with_history(
        motion, run_history(order, np.asarray(motion.current)[:, 0]), cycle=np.full(order.size, 5.0)
    )


@cache
def swept() -> Motion:
    """From rest, with current and temperature that vary."""
    t = np.arange(200) / 200.0
    x = 0.008 * np.sin(2.0 * np.pi * (1.0 + 2.0 * t) * t)
    current = 0.4 + 0.3 * np.sin(9.0 * t)
    return time_motion(t, x, current=current, temperature=50.0 + 20.0 * t)


@cache
def base() -> np.ndarray:
    return np.asarray(VALVE.force(loops()))


@cache
def computed(kind: type[AbstractEffect], form: tuple) -> Outcome:
    """Not compiled as a whole, so that all effects share the valve's program."""
    force = force_of(kind, dict(form), VALVE, loops())
    table = jnp.asarray(table_of(kind)[0])
    rows = jnp.stack([force(row) for row in table])
    slopes = [
        np.stack([jax.jvp(force, (row,), (unit,))[1] for unit in jnp.eye(row.size)])
        for row in table[:2]
    ]
    return arranged(kind, np.asarray(rows), *slopes)


def outcome(kind: type[AbstractEffect], choice: dict) -> Outcome:
    return computed(kind, tuple(choice.items()))


@each_form
def test_zero_size_is_the_identity(kind, choice):
    zero = outcome(kind, choice).zero
    np.testing.assert_allclose(zero, base(), rtol=0.0, atol=1e-9 * base().max())


@each_form
def test_effect_is_finite_and_does_something(kind, choice):
    result = outcome(kind, choice)
    for values in (result.nominal, result.jacobian, result.at_zero):
        assert np.isfinite(values).all()
    added = np.sqrt(np.mean((result.nominal - base()) ** 2) / np.mean(base() ** 2))
    if kind.facts.id in UNSEEN:
        assert added < 1e-10
    else:
        assert 1e-4 < added < 0.6


@each_form
def test_derivatives_are_those_of_finite_differences(kind, choice):
    result = outcome(kind, choice)
    for k, symbol in enumerate(result.symbols):
        off = share_off(result, k)
        assert off <= 0.01, f"{symbol}: {off:.1%} of the points"


@each_form
def test_what_stands_around_the_valve_adds_its_own(kind, choice):
    """Force, channel and drive act as their formulas say on motion, force and current."""
    effect, motion, valve = make(kind, choice=choice), loops(), base()
    if isinstance(effect, AbstractForceEffect):
        expected = valve + effect.force(motion)
    elif isinstance(effect, AbstractChannelEffect):
        expected = effect.recorded(jnp.asarray(valve), motion)
    elif isinstance(effect, AbstractDriveEffect):
        current = effect.current(motion)
        expected = VALVE.force(eqx.tree_at(lambda m: m.current, motion, current))
    else:
        return
    nominal = outcome(kind, choice).nominal
    np.testing.assert_allclose(nominal, expected, rtol=0.0, atol=1e-9 * valve.max())


@each_form
def test_any_motion_has_a_finite_force(kind, choice):
    motion = swept()
    alone = np.asarray(VALVE.force(motion))
    force = np.asarray(Damper(VALVE, (make(kind, choice=choice),)).force(motion))
    assert np.isfinite(force).all()
    zero = np.asarray(Damper(VALVE, (make(kind, "zero", choice),)).force(motion))
    np.testing.assert_allclose(zero, alone, rtol=0.0, atol=1e-8 * np.abs(alone).max())
