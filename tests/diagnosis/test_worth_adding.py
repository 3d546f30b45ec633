"""When a further effect is a cause of its own, on rounds made by hand."""

from dataclasses import replace

import pytest

from sysid.diagnosis.contenders import (
    LEAST_GAIN,
    LEAST_IF_RIGHT,
    RIGHT,
    STRUCTURAL,
    laws_are_right,
)
from sysid.diagnosis.evidence import gather
from sysid.diagnosis.selection import AGAIN, WEAK, unlike, worth_adding
from sysid.diagnosis.state import settle
from sysid.identification.fit import fit_loops
from sysid.likelihood.discrepancy import Covariance
from sysid.likelihood.reml import full_rank
from sysid.models.damper import Damper
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.rig.trial_campaign import make_trial
from tests.diagnosis.diagnosed import DESIGN
from tests.diagnosis.test_ladder import contender, played
from tests.likelihood.dense import restricted_likelihood


def chosen(gained, *contenders, news=()):
    found = worth_adding(played(*contenders), gained, news)
    return None if found is None else found.id


def test_the_first_effect_must_beat_chance():
    assert chosen({}, contender("gas_spring", 1.1 * LEAST_GAIN)) == "gas_spring"
    assert chosen({}, contender("gas_spring", 0.9 * LEAST_GAIN)) is None


@pytest.mark.parametrize(("part", "taken"), [(1.1, "force_offset"), (0.9, None)])
def test_a_further_effect_must_not_be_what_the_first_formula_misses(part, taken):
    first = 1000.0
    assert WEAK * first > LEAST_GAIN
    assert chosen({"lost_motion": first}, contender("force_offset", part * WEAK * first)) == taken


@pytest.mark.parametrize(
    ("own", "taken"), [(1.0, "force_offset"), (0.5, "force_offset"), (0.1, None)]
)
def test_a_further_effect_must_not_be_the_first_one_in_one_direction(own, taken):
    one = replace(contender("force_offset", 60.0), own=own)
    assert chosen({"friction": 600.0}, one) == taken


def test_a_weak_second_effect_counts_beside_a_weak_first_one():
    assert chosen({"lost_motion": 30.0}, contender("force_offset", 20.0)) == "force_offset"


def test_what_looks_like_the_first_effect_gives_way_to_another_family():
    """A stop beside a spring is more of the spring; the offset is news, though it gains less."""
    stop = contender("bump_stop", 0.9 * AGAIN * 400.0)
    offset = contender("force_offset", 60.0)
    assert chosen({"reactive": 400.0}, stop, offset) == "force_offset"
    strong = contender("bump_stop", 1.1 * AGAIN * 400.0)
    assert chosen({"reactive": 400.0}, strong, offset) == "bump_stop"


def test_what_looks_like_no_earlier_effect_is_news_whatever_its_family():
    """A gas force that grows with temperature, beside a preload of ten times its size."""
    warm = contender("gas_temperature", 60.0)
    assert chosen({"offset": 400.0}, warm) is None
    assert chosen({"offset": 400.0}, warm, news={"gas_temperature"}) == "gas_temperature"
    weak = contender("gas_temperature", 0.9 * WEAK * 400.0)
    assert chosen({"offset": 400.0}, weak, news={"gas_temperature"}) is None
    before = played(contender("force_offset", 400.0))
    assert unlike(warm, before)
    assert not unlike(contender("force_offset", 60.0), before)
    assert not unlike(contender("bump_stop", 60.0), played(contender("gas_spring", 400.0)))


def test_where_laws_are_right_a_smaller_gain_is_enough():
    small = 0.5 * (LEAST_IF_RIGHT + LEAST_GAIN)
    assert chosen({}, contender("gas_spring", small)) is None
    assert chosen({}, replace(contender("gas_spring", small), right=True)) == "gas_spring"


def test_a_change_of_the_laws_need_not_be_as_strong_as_what_a_formula_misses():
    """If it leaves them right: Σ took most of it for a smooth error of them."""
    weak, before = 0.5 * WEAK * 1000.0, {"friction": 1000.0}
    offset, law = (
        replace(contender(kind, weak), right=True) for kind in ("force_offset", "frequency_law")
    )
    assert chosen(before, offset) is None
    assert chosen(before, law) == "frequency_law"
    assert chosen(before, replace(law, right=False)) is None


def test_a_change_of_the_laws_that_the_screen_did_not_show_must_leave_them_right():
    law = contender("frequency_law", 5.0 * LEAST_GAIN)
    unseen = replace(law, scored=replace(law.scored, score=0.5 * law.scored.threshold))
    assert chosen({}, law) == "frequency_law"
    assert chosen({}, unseen) is None
    assert chosen({}, replace(unseen, right=True)) == "frequency_law"


@pytest.mark.parametrize(("misfit", "right"), [(0.0, True), (0.1, False)])
def test_laws_are_right_unless_they_err(misfit, right):
    """Also where Σ takes what the load cell does for an error of the laws, and need not."""
    loops = make_trial(72, (), (), replace(DESIGN, misfit=misfit)).loops
    fit = fit_loops(loops, variant="symmetric", weights="peak")
    coordinates = DamperCoordinates(fit.coordinates, ())
    bare = gather(loops)
    evidence = bare.beside(Damper(fit.valve, ()), bare.residual(coordinates, fit.u))
    state = settle(evidence, coordinates, fit.u)
    assert laws_are_right(evidence, state) == right
    sizes = replace(state.sizes, gain=1e-3, odd=max(0.01, state.sizes.odd))
    covariance = Covariance(evidence.parts, sizes)
    r = state.gls.residual
    assert evidence.energy(covariance.expected(r, STRUCTURAL)) > RIGHT * evidence.energy(r)
    log_likelihood = restricted_likelihood(covariance, r, full_rank(state.gls.jacobian))
    fitted = replace(
        state.restricted, sizes=sizes, covariance=covariance, log_likelihood=log_likelihood
    )
    assert laws_are_right(evidence, replace(state, restricted=fitted)) == right
