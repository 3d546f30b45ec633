"""The lumped model in a loop with what a diagnosis may find beside it."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.cards.export.pieces import WITHOUT_SAY
from sysid.effects.base import AbstractForceEffect
from sysid.effects.law.frequency_law import FrequencyLaw
from sysid.effects.registry import EFFECTS, choices
from sysid.errors import CardError
from sysid.isolator.base_motion import BaseMotion, butterworth_motion
from sysid.isolator.closed_loop import Clock, Trace, sampled, trace
from sysid.isolator.controllers.gain_schedule import GainSchedule
from sysid.isolator.controllers.passive import Passive
from sysid.isolator.element_memory import ElementMemory
from sysid.isolator.families import family
from sysid.isolator.from_card import damper_of_card, why_not
from sysid.isolator.lumped_step import lumped_step
from sysid.isolator.plant import mass_isolator
from sysid.isolator.pointwise_step import PointwiseStep
from sysid.models.damper import Damper
from sysid.models.lumped import TABLE_1, Lumped
from sysid.models.simulate import simulate
from sysid.motion.time_motion import time_motion
from sysid.parameters import build
from tests.cards.export.dampers import effect
from tests.isolator.conftest import lumped_card

CURRENT, WARM = 0.3, 55.0
FINE = Clock(6.25e-5, 1)
run = jax.jit(trace, static_argnums=4)


def one(clock: Clock, seconds: float = 0.3):
    base = butterworth_motion([5], duration=seconds, level=3e-3)
    return jax.tree.map(lambda z: z[0], sampled(base, clock))


def quick(step):
    """The current is there at once, so that `simulate` sees the same."""
    return eqx.tree_at(lambda s: s.tau, step, jnp.asarray(1e-9))


def followed(effects, clock: Clock = FINE) -> tuple[Trace, Damper]:
    damper = damper_of_card(lumped_card(*effects))
    step = damper.step(WARM)
    assert isinstance(step, PointwiseStep)
    found = run(mass_isolator(), quick(step), Passive(jnp.asarray(CURRENT)), one(clock), clock)
    assert damper.lumped is not None
    return found, Damper(damper.lumped, effects)


def error_of(found: Trace, damper: Damper, clock: Clock = FINE) -> float:
    """Of the force against `simulate` on the motion that came out, in parts of the largest.

    What stands beside the valve adds its own force (`tests/contracts/test_effects_lumped.py`), so
    that one compiled program does for all of these.
    """
    damper = eqx.tree_at(lambda d: d.valve.tau, damper, jnp.asarray(1e-9))
    motion = time_motion(
        clock.period * np.arange(found.force.size), np.asarray(found.working_space),
        velocity=np.asarray(found.piston_velocity), current=CURRENT, temperature=WARM,
    )  # fmt: skip
    beside = tuple(e for e in damper.effects if isinstance(e, AbstractForceEffect))
    if beside == damper.effects:
        alone = simulate(Damper(damper.valve), motion)
        expected = np.asarray(sum((e.force(motion) for e in beside), alone))[1:]
    else:
        expected = np.asarray(simulate(damper, motion))[1:]  # a run begins with no force
    return float(np.abs(np.asarray(found.force)[1:] - expected).max() / np.abs(expected).max())


def test_with_nothing_beside_it_is_the_step_of_the_model_alone(valve, number):
    clock = Clock(1e-3, 4)
    beside = PointwiseStep(
        damper=Damper(valve), tau=valve.tau, temperature=number(WARM), currents=valve.currents,
        memories=(ElementMemory(valve),), sided=False,
    )  # fmt: skip
    forces = [
        np.asarray(run(mass_isolator(), s, Passive(number(CURRENT)), one(clock), clock).force)
        for s in (lumped_step(valve, number(WARM)), beside)
    ]
    np.testing.assert_allclose(forces[1], forces[0], rtol=0, atol=1e-7 * np.abs(forces[0]).max())


TAKEN = [
    e
    for kind in EFFECTS
    for choice in choices(kind)
    for e in [kind(**kind.facts.nominal, **choice)]
    if e.stage != "channel"
    and e.facts.id not in (*WITHOUT_SAY, "gas_spring")
    and not why_not(e, Damper(build(Lumped, TABLE_1), (e,)))
]
"""All that a lumped card may have beside it, in every form."""


IDLE = ("width_law", "bump_stop")
"""Without a sign of acceleration there is no width; the stop is not reached."""


@pytest.mark.parametrize("beside", TAKEN, ids=lambda e: e.facts.id)
def test_each_effect_acts_as_in_simulate(beside):
    """On the motion that the loop made; without it, the force is another one."""
    found, damper = followed((beside,))
    error = error_of(found, damper)
    assert error < 2e-3
    without = error_of(found, Damper(damper.valve))
    assert beside.facts.id in IDLE or without > 1.2 * error


def test_many_at_once_act_as_in_simulate_to_second_order():
    """Laws change the element's own numbers, as they do there."""
    many = ("current_saturation", "eddy_loss", "stiffness_temperature", "bypass_leakage",
            "seal_friction", "presliding_friction", "quadratic_loss")  # fmt: skip
    errors = []
    for clock in (FINE, Clock(0.5 * FINE.period, 1)):
        found, damper = followed(tuple(map(effect, many)), clock)
        errors.append(error_of(found, damper, clock))
    assert errors[0] < 3e-3
    assert errors[1] < errors[0] / 3.0


def phasor(damper, frequency: float) -> complex:
    """Of the force of a damper that is moved by 0.126 m/s, N."""
    t = 1e-3 * np.arange(round(3e3 / frequency) + 1)
    x = 0.02 / frequency * np.sin(2.0 * np.pi * frequency * t) * np.minimum(1.0, 20.0 * t)
    base = jax.tree.map(lambda z: z[0], sampled(BaseMotion(1e-3, x[None], "sine")))
    found = run(mass_isolator(1e9, 1.0), damper, Passive(jnp.asarray(CURRENT)), base, Clock())
    last = round(1e3 / frequency)
    turn = np.exp(-2j * np.pi * frequency * t[-last - 1 : -1])
    return complex(np.mean(np.asarray(found.force)[-last:] * turn))


def test_a_law_of_frequency_filters_the_force_of_the_valve_only(number):
    """At 1 Hz nothing, at 10 Hz one decade; forces beside the valve stay as they are."""
    law, beside = FrequencyLaw(eps_f=number(0.2)), effect("linear_viscosity")
    changes = []
    for others in ((), (beside,)):
        with_law, without = (
            damper_of_card(lumped_card(*others, *own)).step(WARM) for own in ((law,), ())
        )
        forces = {f: (phasor(with_law, f), phasor(without, f)) for f in (1.0, 10.0)}
        changes.append(forces[10.0][0] - forces[10.0][1])
        if not others:
            assert abs(forces[1.0][0]) == pytest.approx(abs(forces[1.0][1]), rel=0.02)
            assert abs(forces[10.0][0]) == pytest.approx(1.2 * abs(forces[10.0][1]), rel=0.03)
    assert abs(changes[1] - changes[0]) < 1e-3 * abs(changes[0])


def test_gain_scheduling_reads_the_same_table_with_and_without_a_memory(valve, number):
    forces = []
    for card in (lumped_card(), lumped_card(effect("bump_stop"))):
        schedule = family("GS", damper_of_card(card).table_from(15.0)).controllers
        assert isinstance(schedule, GainSchedule)
        forces.append(np.asarray(schedule.forces)[0])
    np.testing.assert_allclose(forces[1], forces[0], rtol=1e-6)


def test_what_the_lumped_model_cannot_have_is_named():
    for refused, why in (
        ((effect("coil_lag"),), "has a lag of the current already"),
        ((effect("backlash"),), "keeps no state"),
        ((effect("series_compliance"), effect("seal_friction")), "forces stand between"),
    ):
        with pytest.raises(CardError, match=why):
            damper_of_card(lumped_card(*refused))
