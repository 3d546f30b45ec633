"""Conflict diagrams: orderings and signs of the paper, seeds, bad input."""

import numpy as np
import pytest

from sysid.effects.registry import effect_kind, make
from sysid.errors import CardError, DataError
from sysid.isolator.base_motion import butterworth_motion, road_motion
from sysid.isolator.closed_loop import Clock
from sysid.isolator.compare import band, change, rival
from sysid.isolator.families import CONTROLLED, family
from sysid.isolator.from_card import alone, at_temperatures, damper_of_card
from sysid.isolator.hardware_in_loop import Actuator, rig_isolator
from sysid.isolator.plant import mass_isolator
from sysid.isolator.quarter_car import quarter_car
from sysid.isolator.sensitivity import CASES, changes_by_law, one_law_at_a_time
from sysid.isolator.study import conflict_diagram, stacked
from tests.cards.example import card_with
from tests.isolator.conftest import lumped_card

CLOCK = Clock(1e-3, 4)
NAMES = ("15 °C", "75 °C")


@pytest.fixture(scope="module")
def base():
    return butterworth_motion([1, 2, 3], duration=3.0)


@pytest.fixture(scope="module")
def dampers(valve):
    return at_temperatures(valve, (15.0, 75.0))


@pytest.fixture(scope="module")
def diagram(valve, dampers, base):
    families = [family(name, valve) for name in CONTROLLED]
    return conflict_diagram(mass_isolator(), families, dampers, NAMES, base, CLOCK)


def test_orderings_at_equal_working_space(diagram):
    """P ≈ PID < GS < OO in RMS acceleration at 15 °C; at 75 °C GS comes near P (BS09 Fig. 11)."""
    excess = {n: rival(diagram, n, "P", 0).excess.value for n in ("PID", "GS", "OO")}
    assert abs(excess["PID"]) < 0.01
    assert max(0.0, excess["PID"]) < excess["GS"] < 0.03
    assert excess["OO"] > 0.05
    warm = {n: rival(diagram, n, "P", 1).excess.value for n in ("PID", "GS", "OO")}
    assert max(abs(warm["PID"]), abs(warm["GS"])) < 0.02 < warm["OO"]


@pytest.mark.parametrize("name", ["P", "PID", "GS"])
def test_warmth_lowers_acceleration_and_takes_space(diagram, name):
    found = change(diagram.curve(name), 2000.0, 0, 1)
    assert -0.18 < found.acceleration.value < -0.10
    assert 0.04 < found.working_space.value < 0.10


def test_laws_one_at_a_time(valve, base):
    """BS09 Fig. 12: k up lowers acceleration, F_y raises it, C_post has the largest effect."""
    families = [family("P", valve, set_points=(2000.0,))]
    dampers = stacked(one_law_at_a_time(alone(valve), 15.0, 75.0))
    found = conflict_diagram(mass_isolator(), families, dampers, CASES, base, CLOCK)
    by = {case: one[0].acceleration.value for case, one in changes_by_law(found).items()}
    assert by["k"] < -0.005
    assert by["F_y"] > 0.005
    assert by["C_post"] < -0.08
    assert abs(by["C_post"]) > 3 * max(abs(by["k"]), abs(by["F_y"]))


def test_a_rig_shifts_the_curves_and_on_off_stays_last(valve, dampers, base, diagram):
    families = [family(name, valve) for name in ("P", "OO")]
    late = rig_isolator(Actuator(2e-3))
    found = conflict_diagram(late, families, dampers, NAMES, base, CLOCK)
    assert np.all(found.curve("P").acceleration > 1.03 * diagram.curve("P").acceleration)
    assert rival(found, "OO", "P", 0).excess.value > 0.05
    # an actuator that is hardly late is none
    quick = conflict_diagram(rig_isolator(Actuator(2e-5)), families, dampers, NAMES, base, CLOCK)
    np.testing.assert_allclose(
        quick.curve("P").acceleration, diagram.curve("P").acceleration, rtol=0.02
    )


def test_a_quarter_car_has_the_frequencies_that_it_must():
    found = np.linalg.eigvals(np.asarray(quarter_car(250.0, 35.0, 16e3, 160e3).matrix))
    exact = np.linalg.eigvals(
        np.linalg.solve(np.diag([250.0, 35.0]), [[16e3, -16e3], [-16e3, 176e3]])
    )
    np.testing.assert_allclose(np.sort(found.imag)[2:], np.sort(np.sqrt(exact)), rtol=1e-9)


def test_seeds_make_the_motions():
    one, same = (butterworth_motion([7, 8], duration=0.2) for _ in range(2))
    np.testing.assert_array_equal(one.displacement, same.displacement)
    assert np.abs(one.displacement[0] - one.displacement[1]).max() > 1e-4
    alone = butterworth_motion([8], duration=0.2)
    np.testing.assert_array_equal(alone.displacement[0], one.displacement[1])


def test_noise_has_its_level_and_ends_at_its_cutoff():
    many = butterworth_motion(range(40), duration=5.0, level=2e-3, cutoff=25.0, order=4)
    assert np.std(many.displacement[:, 1000:]) == pytest.approx(2e-3, rel=0.03)
    power = np.mean(np.abs(np.fft.rfft(many.displacement[:, 1:], axis=1)) ** 2, axis=0)
    low, cut = power[5:50].mean(), power[115:136].mean()  # bins of 0.2 Hz, about 25 Hz
    assert cut / low == pytest.approx(0.5, abs=0.1)


def test_a_road_has_the_spectrum_of_its_class():
    """G_d at n_0 = 0.1 cycles/m, which is 2 Hz at 20 m/s."""
    found = road_motion(range(30), road="B", speed=20.0, duration=5.0).displacement[:, 500:4500]
    power = np.mean(np.abs(np.fft.rfft(found, axis=1)) ** 2, axis=0) * 2e-3 / found.shape[1]
    per_hertz = power[7:10].mean()
    assert per_hertz * 20.0 == pytest.approx(64e-6, rel=0.35)


def test_bad_motions_are_refused():
    for order in ({"level": -1.0}, {"cutoff": 400.0}, {"order": 0}, {"duration": 0.0}):
        with pytest.raises(DataError):
            butterworth_motion([1], **order)
    with pytest.raises(DataError, match="seeds"):
        butterworth_motion([])
    with pytest.raises(DataError, match="class 'Z'"):
        road_motion([1], road="Z")


def test_cards_that_cannot_run_are_refused_by_name():
    remembers = card_with(make(effect_kind("seating_leakage")))
    with pytest.raises(CardError, match="'seating_leakage'"):
        damper_of_card(remembers)
    with pytest.raises(CardError, match="'backlash'"):
        damper_of_card(lumped_card(make(effect_kind("backlash"))))
    one = {s: v for s, v in lumped_numbers().items() if "[" not in s or "[0 A]" in s}
    with pytest.raises(CardError, match="one current"):
        damper_of_card(lumped_card(numbers=one))


def lumped_numbers():
    return {p.symbol: p.value for p in lumped_card().parameters}


def test_a_gas_spring_is_taken_and_a_channel_left_out_with_a_word():
    card = lumped_card(make(effect_kind("gas_spring")), make(effect_kind("force_offset")))
    found = damper_of_card(card)
    assert found.gas.stiffness == 1500.0
    assert "force_offset" in found.left_out[0]


def test_a_band_is_students_interval():
    found = band(np.array([1.0, 2.0, 3.0, 4.0]))
    assert found.value == 2.5
    assert found.high - 2.5 == pytest.approx(3.182446 * np.std([1, 2, 3, 4], ddof=1) / 2)
    assert (found.single_low, found.single_high) == pytest.approx((1.075, 3.925))
