"""Which contender leads a round, and what the others are measured from."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis.contenders import EVEN, Contender, best_first, from_first
from sysid.diagnosis.extension import Extended
from sysid.diagnosis.judged import unconfirmed_alone
from sysid.diagnosis.ladder import Shares
from sysid.diagnosis.scores import Scored
from sysid.diagnosis.selection import Selection, led_by
from sysid.diagnosis.state import State, settle
from sysid.effects.registry import effect_kind, make
from sysid.models.damper_coordinates import DamperCoordinates
from tests.diagnosis.bare import bare
from tests.diagnosis.test_stability import played


def contender(id: str, gain: float) -> Contender:
    return Contender(bare(Scored, effect=make(effect_kind(id))), bare(State), gain)


def test_others_are_measured_from_the_contender_that_was_chosen():
    """Not from one that was passed over: a rival far from that one may be near the chosen one."""
    _, one = played(lambda x, v, a, A, f: 3000 * x)
    one = replace(one, contenders=tuple(from_first(one.before, one.contenders)))
    best, chosen, rival = one.contenders
    assert best.apart == 0.0
    assert chosen.apart > 1.0
    led = led_by(one, chosen)
    assert [c.id for c in led.contenders] == [chosen.id, rival.id]
    assert led.contenders[0].apart == 0.0
    difference = (rival.state.gls.residual - chosen.state.gls.residual)[:, :, None]
    distance = np.sqrt(one.before.covariance.inner(difference, difference)[0, 0])
    assert led.contenders[1].apart == pytest.approx(distance)
    assert led.contenders[1].apart != pytest.approx(rival.apart, rel=0.01)


@pytest.mark.parametrize("ahead", [-1.0, 1.0])
def test_contenders_that_gain_as_much_come_in_the_order_of_the_catalogue(ahead):
    """One force in these tests: which of them gains a little more is rounding."""
    spring, mass = (
        contender("gas_spring", 40.0),
        contender("fluid_inertia", 40.0 + 0.5 * ahead * EVEN),
    )
    assert [c.id for c in best_first([mass, spring])] == ["gas_spring", "fluid_inertia"]
    assert [c.id for c in best_first([spring, mass])] == ["gas_spring", "fluid_inertia"]


def test_what_gains_more_comes_first_whatever_the_catalogue_says():
    spring, mass = contender("gas_spring", 40.0), contender("fluid_inertia", 41.0)
    other = contender("backlash", 45.0)
    assert [c.id for c in best_first([spring, mass, other])] == [
        "backlash",
        "fluid_inertia",
        "gas_spring",
    ]
    assert best_first([]) == []


@pytest.fixture(scope="module")
def with_a_second(evidence, spring_state) -> State:
    """A spring that is there, and friction of the stroke that is not."""
    more = make(effect_kind("position_friction"))
    coordinates = DamperCoordinates(
        spring_state.coordinates.valve_coordinates, (*spring_state.coordinates.prototypes, more)
    )
    start = np.append(spring_state.u, 0.05)
    return settle(evidence, coordinates, start, spring_state.covariance)


def extended(evidence, base_state, final: State, *, coarse: bool = False) -> Extended:
    selection = Selection(base_state, (), final.ids, final, evidence)
    return bare(Extended, selection=selection, share=Shares(1.0, 1.0, 0.0), coarse=coarse)


def test_with_few_conditions_each_effect_is_confirmed_beside_the_others(
    evidence, base_state, with_a_second
):
    """The spring's gain on conditions left out does not speak for what was added beside it."""
    few = replace(evidence, condition=evidence.condition % 4)
    found = unconfirmed_alone(extended(few, base_state, with_a_second))
    assert found == {"position_friction"}
    assert unconfirmed_alone(extended(few, base_state, with_a_second, coarse=True)) == set()
    assert unconfirmed_alone(extended(evidence, base_state, with_a_second)) == set()
