"""Controllers by themselves."""

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.errors import DataError
from sysid.isolator.controllers.gain_schedule import GainSchedule, schedule
from sysid.isolator.controllers.on_off import OnOff
from sysid.isolator.controllers.pid import pid
from sysid.isolator.controllers.proportional import proportional
from sysid.isolator.families import CONTROLLED, ON_CURRENTS, Gains, family, table_of
from sysid.isolator.from_card import damper_of_card
from sysid.isolator.skyhook import Sensed
from tests.cards.example import example_card

PERIOD = jnp.asarray(1e-3)


def sensed(body, relative, force=0.0):
    return Sensed(*(jnp.asarray(float(z)) for z in (body, relative, force)))


@pytest.mark.parametrize("name", CONTROLLED)
@pytest.mark.parametrize(("body", "relative"), [(0.3, 0.2), (-0.3, -0.2)])
def test_no_current_where_energy_would_be_needed(name, body, relative, valve):
    """BS09 Eq. 2: ẋ_m (ẋ_m − ẋ_b) < 0, the relative velocity being ẋ_b − ẋ_m."""
    import jax

    one = jax.tree.map(lambda z: z[-1], family(name, valve).controllers)
    memory, current = one.command(one.start(), sensed(body, relative, 50.0), PERIOD)
    assert float(current) == 0.0
    memory, current = one.command(memory, sensed(body, -relative, -50.0), PERIOD)
    assert float(current) > 0.0


def test_proportional_works_on_magnitudes():
    """Mirrored motion asks for the same current: G (D |v| − B |F|)."""
    one = proportional(jnp.asarray(2000.0))
    for sign in (1.0, -1.0):
        _, current = one.command((), sensed(0.4 * sign, -0.1 * sign, -300.0 * sign), PERIOD)
        assert float(current) == pytest.approx(0.0012 * (800.0 - 0.6 * 300.0))


def test_the_integral_starts_anew_where_the_condition_changes():
    one = pid(jnp.asarray(2000.0))
    memory, currents = one.start(), []
    for body in (0.3, 0.3, 0.3, -0.3, 0.3):
        memory, current = one.command(memory, sensed(body, -0.1, -100.0), PERIOD)
        currents.append(float(current))
    error = 2000.0 * 0.3 - 100.0
    assert currents[0] == pytest.approx(5e-4 * error)
    assert currents[2] == pytest.approx(5e-4 * error + 0.2 * 2e-3 * error)
    assert currents[3] == 0.0
    assert currents[4] == pytest.approx(currents[0])


def test_the_schedule_inverts_the_quasi_steady_force(valve):
    forces, currents = table_of(valve, Gains(temperature=15.0, speed=0.25))
    post, yielding = 1265.0 - 7.07 * 15.0, 331.0 - 0.53 * 15.0
    assert forces[1] == pytest.approx(yielding + 0.25 * post)  # at 0.2 A
    one = GainSchedule(jnp.asarray(1000.0), jnp.asarray(forces), jnp.asarray(currents))
    for wanted in (100.0, forces[1], 900.0, 5000.0):
        _, current = one.command((), sensed(wanted / 1000.0, -0.2), PERIOD)
        assert float(current) == pytest.approx(np.interp(wanted, forces, currents))


def test_a_force_that_falls_with_current_cannot_be_scheduled():
    with pytest.raises(DataError, match="rises with current"):
        schedule((0.0, 1.0), np.array([100.0, 90.0]), np.array([1000.0, 1000.0]))


def test_on_off():
    one = OnOff(jnp.asarray(0.2))
    assert float(one.command((), sensed(1.0, -1.0), PERIOD)[1]) == 0.2


def test_set_points_end_at_the_largest_current_of_the_damper(valve):
    """0.4 A on a damper of 0.3 A would be the run at 0.3 A under another name."""
    card = example_card()
    box = card.validity.model_copy(update={"current": (0.0, 0.3)})
    few = damper_of_card(card.model_copy(update={"validity": box})).table_from(40.0)
    points = family("OO", few).set_points
    assert max(points) == 0.3
    assert len(set(points)) == len(points)
    assert family("OO", valve).set_points[-1] == 0.4
    assert family("P", few).set_points == family("P", valve).set_points


@pytest.mark.parametrize(
    ("largest", "last"),
    [(0.15, 0.15), (0.3, 0.3), (1.0, 0.4), (1.0004, 0.4), (1.9999, 0.8), (2.5, 1.0), (5.0, 2.0)],
)
def test_on_off_goes_as_far_for_a_damper_of_larger_currents(largest, last):
    """As a part of what the damper takes; the paper's currents are among them."""
    card = example_card()
    box = card.validity.model_copy(update={"current": (0.0, largest)})
    strong = damper_of_card(card.model_copy(update={"validity": box})).table_from(40.0)
    points = family("OO", strong).set_points
    assert points[-1] == last
    assert set(ON_CURRENTS) & set(points) == {i for i in ON_CURRENTS if i <= largest}
    assert family("OO", strong, set_points=(0.2,)).set_points == (min(0.2, largest),)
