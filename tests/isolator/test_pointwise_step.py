"""W11's model in an isolator: the loop through acceleration, against the exported C program."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sysid.errors import CardError
from sysid.isolator.base_motion import BaseMotion, butterworth_motion
from sysid.isolator.card_study import Order, study_card
from sysid.isolator.closed_loop import Clock, Trace, sampled, trace
from sysid.isolator.controllers.passive import Passive
from sysid.isolator.families import family
from sysid.isolator.fractional_power import fractional_power
from sysid.isolator.from_card import damper_of_card
from sysid.isolator.memory import instant
from sysid.isolator.plant import mass_isolator
from sysid.isolator.pointwise_step import PointwiseStep
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.parameters import build
from tests.cards.example import card_with
from tests.cards.export.dampers import effect
from tests.cards.export.program import COMPUTED, Program, needs_compiler
from tests.models.rival_examples import example

CURRENT = 0.1
LAG = 0.003


def step(**changed: float) -> PointwiseStep:
    damper = Damper(build(Generalized, LOW_SYMMETRIC | changed))
    return PointwiseStep(
        damper=damper, tau=jnp.asarray(LAG), temperature=jnp.asarray(40.0), currents=(0.0, 0.2, 0.4)
    )


def run(steps: int) -> Trace:
    clock = Clock(steps=steps)
    base = jax.tree.map(lambda z: z[0], sampled(butterworth_motion([1], duration=1.0), clock))
    return trace(mass_isolator(), step(), Passive(jnp.asarray(CURRENT)), base, clock)


@pytest.fixture(scope="module")
def usual() -> Trace:
    return run(8)


@needs_compiler
def test_it_is_what_the_exported_program_does_in_a_plant(usual, tmp_path):
    plant, h = mass_isolator(), 4e-5
    mass = 1.0 / float(plant.force[1])
    spring = float(plant.base[1]) * mass
    t = np.arange(round(1.0 / h)) * h
    speed = butterworth_motion([1], duration=1.0).at(t)[1][0]
    rises = np.gradient(speed, t)
    program = Program("generalized", step().damper, tmp_path)
    x, v, forces = 0.0, 0.0, []
    for now, rise in zip(t.tolist(), rises.tolist(), strict=True):
        i = CURRENT * (1.0 - np.exp(-now / LAG))
        rest = mass * rise - spring * x
        a, force, code = program.in_plant([now, x, v, np.nan, i, 40.0], mass, rest)
        assert code in COMPUTED
        forces.append(force)
        v += h * a
        x += h * v
    expected = np.interp(1e-3 * np.arange(usual.force.size), t, forces)
    error = np.asarray(usual.force) - expected
    assert np.sqrt(np.mean(error**2)) < 0.003 * np.abs(expected).max()


def test_finer_steps_change_little(usual):
    fine = run(32)
    error = np.asarray(usual.force - fine.force)
    assert np.sqrt(np.mean(error**2)) < 0.002 * float(jnp.abs(fine.force).max())


def test_the_damper_knows_what_the_plant_does(usual):
    """At every sample the piston's speed is the plant's, and the side that of its acceleration."""
    velocity = np.asarray(usual.piston_velocity)
    speed, side, force = (np.asarray(z) for z in usual.damper[:3])
    assert np.allclose(speed, velocity, atol=1e-9)
    assert np.allclose(force, usual.force)
    rising = np.gradient(velocity)
    sure = np.abs(rising) > 0.1 * np.abs(rising).max()
    assert np.mean(np.sign(rising[sure]) == side[sure]) > 0.97


def test_a_thin_loop_is_solved_exactly():
    """Without width the acceleration matters through the peak speed alone."""
    thin = step(k_4=0.0, a_1=0.0, k_0=0.0, k_1c=0.0, k_1e=0.0)
    at = instant(*(jnp.asarray(z) for z in (0.002, 0.01, -3.0, -1.0, 0.2, 40.0)))
    found = thin.force(at)
    valve = thin.damper.valve
    assert isinstance(valve, Generalized)
    gain = float(valve.force_gain(jnp.asarray(0.2)))
    expected = gain * 2.0 * float(valve.F_0) * np.tanh(0.5 * float(valve.a_0) * 0.01)
    assert float(found) == pytest.approx(expected)


def test_gain_scheduling_reads_its_table_from_the_force_at_a_speed():
    forces = family("GS", step()).controllers.forces
    assert np.all(np.diff(np.asarray(forces)[0]) > 0.0)


def test_a_card_of_the_generalised_model_is_studied():
    order = Order("quarter-car", controllers=("P",), motions=2, draws=0, duration=0.3)
    study = study_card(card_with(effect("seal_friction"), effect("force_offset")), order)
    assert study.temperatures == (40.0,)
    assert study.left_out == ("force_offset is the recorder's, no force on the mass",)
    assert not study.changes
    better = float(np.nanmin(study.diagram.curve("P").acceleration))
    assert 0.0 < better < float(np.nanmin(study.passive.acceleration)) * 1.2


@pytest.mark.parametrize("id", ["backlash", "bypass_leakage", "series_compliance"])
def test_what_remembers_is_refused_by_name(id):
    with pytest.raises(CardError, match=id):
        damper_of_card(card_with(effect(id)))


def test_temperature_counts_where_an_effect_knows_it():
    assert damper_of_card(card_with(effect("viscosity_temperature"))).warm
    assert not damper_of_card(card_with(effect("gas_spring"))).warm


@pytest.mark.parametrize("model", ["tanh", "carreau"])
def test_a_law_of_frequency_does_not_filter_the_gas(model):
    """What it adds at 10 Hz, one decade above 1 Hz, is the same with a stiff gas and with none."""
    clock, t = Clock(1e-3, 8), 1e-3 * np.arange(501)
    x = 2e-3 * np.sin(2.0 * np.pi * 10.0 * t) * np.minimum(1.0, 20.0 * t)
    base = jax.tree.map(lambda z: z[0], sampled(BaseMotion(1e-3, x[None], "sine"), clock))

    def force(stiffness: float, power: object) -> np.ndarray:
        valve = example(model, k=stiffness, f_0=0.0)
        held = PointwiseStep(
            damper=Damper(valve), tau=jnp.asarray(LAG), temperature=jnp.asarray(40.0),
            currents=(0.0, 0.2, 0.4), power=power,
        )  # fmt: skip
        return np.asarray(trace(mass_isolator(1e9, 1.0), held, Passive(jnp.asarray(0.1)), base,
                                clock).force)  # fmt: skip

    added = [force(k, fractional_power(0.2)) - force(k, None) for k in (0.0, 5e4)]
    assert np.abs(added[0]).max() > 10.0
    np.testing.assert_allclose(added[1], added[0], atol=0.01 * np.abs(added[0]).max())
