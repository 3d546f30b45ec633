"""What may be asserted, on rounds made by hand."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis.contenders import Contender, Round
from sysid.diagnosis.decoys import STRANGE
from sysid.diagnosis.ladder import (
    APART,
    AS_MUCH,
    CAP,
    CLEARLY,
    ENOUGH,
    HALF,
    HIGHEST,
    LEAST_EVIDENCE,
    NEARLY,
    PART,
    SHORT,
    STANDS_IN,
    STRONG,
    UNSURE,
    Shares,
    limits_of,
    outside,
    rivals_of,
    verdict,
)
from sysid.diagnosis.scores import Scored
from sysid.diagnosis.state import State
from sysid.effects.registry import effect_kind, make
from sysid.identification.problem import loop_problem
from sysid.likelihood.compress import harmonic_basis
from sysid.likelihood.discrepancy import Covariance, Sizes, covariance_parts
from sysid.likelihood.gls import GlsFit
from sysid.likelihood.reml import Restricted
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.models.generalized_coordinates import GeneralizedCoordinates
from tests.diagnosis.test_lack_of_fit import POINTS, campaign

BASIS = harmonic_basis(POINTS)
LOOPS = campaign(lambda x, v, a, A, f, i: (200 + 1500 * i) * np.tanh(v / 0.01), noise=5.0)
WHOLE = Shares(explained=0.95, beside_laws=0.95, law_shaped=0.1)
SHAPES = {
    "gas_spring": LOOPS.displacement,
    "bump_stop": LOOPS.displacement + 0.05 * (LOOPS.displacement / 0.05) ** 3,
    "fluid_inertia": LOOPS.acceleration / 100.0,
    "fixture_inertia": LOOPS.acceleration / 100.0,
    "force_offset": np.ones_like(LOOPS.displacement),
    "gas_temperature": np.linspace(-20.0, 20.0, len(LOOPS.ids))[:, None] + 0.0 * LOOPS.force,
    "backlash": np.abs(LOOPS.displacement) * np.sign(LOOPS.velocity),
    "frequency_law": np.log10(LOOPS.frequency)[:, None] * LOOPS.force,
}


def state(parameters: int) -> State:
    """A model of no interest but for how many parameters it has."""
    parts = covariance_parts(LOOPS, BASIS)
    sizes = Sizes(gain=0.01, offset=2.0, delay=1e-4)
    covariance = Covariance(parts, sizes)
    jacobian = np.repeat(BASIS.compress(LOOPS.velocity)[:, :, None], parameters, axis=2)
    gls = GlsFit(
        np.zeros(parameters), 1.0, np.zeros_like(parts.force), jacobian, np.eye(parameters), 1, True
    )
    reference = loop_problem(LOOPS).reference
    coordinates = DamperCoordinates(GeneralizedCoordinates(reference, "symmetric"), ())
    return State(coordinates, gls, Restricted(sizes, covariance, 0.0, np.zeros(8)), 0.0)


STATES = {parameters: state(parameters) for parameters in (13, 14, 15)}
STATE = STATES[13]


def contender(id: str, gain: float, apart: float = 50.0, parameters: int = 14) -> Contender:
    scored = Scored(make(effect_kind(id)), 400.0, 14.0, 0.5, 1.0, 0.05, BASIS.compress(SHAPES[id]))
    return Contender(scored, STATES[parameters], gain, apart)


def played(*contenders: Contender) -> Round:
    return Round(STATE, tuple(c.scored for c in contenders), contenders)


def test_a_clear_winner_is_named():
    found = verdict(
        played(contender("gas_spring", 300.0), contender("backlash", 40.0)), WHOLE, False
    )
    assert (found.status, found.members) == ("named", ("gas_spring",))
    assert found.confidence == pytest.approx(CAP, abs=0.001)


def test_confidence_is_highest_where_two_bases_agree():
    one = played(contender("gas_spring", 300.0), contender("backlash", 40.0))
    assert verdict(one, WHOLE, True).confidence == pytest.approx(HIGHEST, abs=0.001)


def test_a_close_race_between_unlike_effects_makes_a_class():
    """Behind by less than its distance allows by chance."""
    rival = contender("backlash", 300.0 - 0.9 * APART * 50.0)
    one = played(contender("gas_spring", 300.0), rival)
    found = verdict(one, WHOLE, False)
    assert (found.status, found.members) == ("class", ("gas_spring", "backlash"))
    further = contender("backlash", 300.0 - 1.1 * APART * 50.0)
    assert rivals_of(replace(one, contenders=(one.contenders[0], further)), one.contenders[0]) == ()


def test_a_rival_that_would_not_be_added_itself_is_none():
    """What gains next to nothing is no other explanation, however near it is."""
    first = contender("gas_spring", 14.0)
    weak = contender("force_offset", 0.9 * AS_MUCH * first.gain, apart=5.0)
    assert LEAST_EVIDENCE < first.gain - weak.gain < APART * weak.apart
    assert rivals_of(played(first, weak), first) == ()
    half = contender("force_offset", 1.1 * AS_MUCH * first.gain, apart=5.0)
    assert rivals_of(played(first, half), first) == (half,)
    near = contender("force_offset", 14.0 - 0.9 * LEAST_EVIDENCE, apart=5.0)
    assert rivals_of(played(first, near), first) == (near,)


def test_effects_that_look_alike_must_be_told_clearly_apart():
    first = contender("fluid_inertia", 300.0)
    near = contender("fixture_inertia", 300.0 - 0.9 * CLEARLY, apart=0.1)
    far = contender("fixture_inertia", 300.0 - 1.1 * CLEARLY, apart=0.1)
    assert verdict(played(first, near), WHOLE, False).members == (
        "fluid_inertia",
        "fixture_inertia",
    )
    assert verdict(played(first, far), WHOLE, False).status == "named"


def test_an_effect_that_contains_the_winner_is_no_rival():
    """A stop that begins at the centre, with a parameter more, is the spring."""
    stop = contender("bump_stop", 299.0, apart=0.5, parameters=15)
    found = verdict(played(contender("gas_spring", 300.0), stop), WHOLE, False)
    assert (found.status, found.members) == ("named", ("gas_spring",))
    assert found.confidence == pytest.approx(CAP, abs=0.001)


def test_a_name_needs_most_of_the_error_explained():
    one = played(contender("gas_spring", 300.0), contender("fluid_inertia", 40.0))
    part = 0.5 * (HALF + ENOUGH)
    found = verdict(one, Shares(part, part, 0.1), False)
    assert found.status == "family"
    assert 0.5 < found.confidence < 0.8
    little = 0.9 * HALF
    assert verdict(one, Shares(little, little, 0.1), False).status is None


def test_half_explained_by_rivals_of_two_families_asserts_nothing():
    """Neither the name nor the family is known."""
    one = played(contender("gas_spring", 300.0), contender("backlash", 290.0))
    part = 0.5 * (HALF + ENOUGH)
    assert verdict(one, Shares(part, part, 0.1), False).status is None


def test_a_name_that_leaves_strong_evidence_is_only_a_family():
    """The effect stands in for something that it is merely similar to."""
    one = played(contender("gas_spring", 400.0))
    little, much = 0.9 * STANDS_IN * 400.0, 1.1 * STANDS_IN * 400.0
    assert min(little, much) > STRONG
    assert verdict(one, WHOLE, False, leftover=little).status == "named"
    assert verdict(one, WHOLE, False, leftover=much).status == "family"


def test_errors_of_the_laws_do_not_count_against_a_name():
    one = played(contender("gas_spring", 300.0))
    assert verdict(one, Shares(0.2, 0.95, 0.9), False).status == "named"


def test_confidence_grows_with_the_lead_and_the_share():
    def confidence(second: float, part: float) -> float:
        one = played(contender("gas_spring", 300.0), contender("backlash", second, apart=0.1))
        return verdict(one, Shares(part, part, 0.1), False).confidence

    assert confidence(295.0, 0.95) < confidence(290.0, 0.95) < confidence(200.0, 0.95)
    assert confidence(200.0, ENOUGH) < confidence(200.0, 0.95)


def test_a_seal_that_slides_at_once_may_be_plain_friction():
    friction = make(effect_kind("presliding_friction"))
    travel = float(friction.F_ps) / float(friction.sigma_0)  # type: ignore[attr-defined]  # its parameters
    assert limits_of(friction, 0.5 * travel / SHORT) == ()
    assert limits_of(friction, 2.0 * travel / SHORT) == ("seal_friction",)
    assert limits_of(make(effect_kind("gas_spring")), 1e-6) == ()
    found = verdict(played(contender("gas_spring", 300.0)), WHOLE, False, ("bump_stop",))
    assert (found.status, found.members) == ("class", ("gas_spring", "bump_stop"))


def test_an_effect_that_is_needed_beside_the_winner_is_no_rival():
    one = played(contender("gas_spring", 300.0), contender("backlash", 290.0))
    assert verdict(one, WHOLE, False).status == "class"
    assert verdict(one, WHOLE, False, kept=("gas_spring", "backlash")).status == "named"


def test_what_was_ahead_and_is_in_the_model_as_well_says_nothing_against_the_chosen_one():
    """Tests left out are predicted better by the chosen one first, and by the other beside it."""
    one = played(contender("gas_spring", 159.0), contender("backlash", 205.0, parameters=15))
    found = verdict(one, WHOLE, False, kept=("gas_spring", "backlash"))
    assert (found.status, found.members) == ("named", ("gas_spring",))
    assert found.confidence == pytest.approx(CAP, abs=0.001)
    assert verdict(one, WHOLE, False, kept=("gas_spring",)).status == "class"
    behind = played(contender("gas_spring", 159.0), contender("backlash", 157.0, apart=0.1))
    assert verdict(behind, WHOLE, False, kept=("gas_spring", "backlash")).status == "family"


def test_where_a_decoy_explains_much_no_name_is_given():
    """Only the family: what was chosen stands in for something outside the catalogue."""
    one = played(contender("gas_spring", 60.0))
    assert verdict(one, WHOLE, False, strange=False).status == "named"
    found = verdict(one, WHOLE, False, strange=True)
    assert (found.status, found.members) == ("family", ("gas_spring",))
    assert found.confidence < CAP


def test_the_strongest_effect_may_leave_a_part_of_its_gain_to_decoys():
    assert not outside(STRANGE - 1.0, (60.0,))
    assert outside(STRANGE + 1.0, (60.0,))
    assert not outside(0.9 * PART * 1000.0, (60.0, 1000.0))
    assert outside(1.1 * PART * 1000.0, (60.0, 1000.0))
    assert outside(STRANGE + 1.0, ())
    assert outside(STRANGE + 1.0, (60.0,), NEARLY - 0.01)
    assert not outside(STRANGE + 1.0, (60.0,), NEARLY + 0.01), "next to nothing is left"


def test_a_doubtful_name_becomes_its_family():
    """Ahead of an excluded rival by so little that the confidence is below UNSURE."""
    near = played(contender("gas_spring", 300.0), contender("fluid_inertia", 296.0, apart=0.5))
    sure = played(contender("gas_spring", 300.0), contender("fluid_inertia", 288.0, apart=0.5))
    part = Shares(ENOUGH, ENOUGH, 0.1)
    found = verdict(near, part, False)
    assert (found.status, found.members) == ("family", ("gas_spring",))
    assert 0.5 < found.confidence < 0.8
    assert verdict(sure, part, False).status == "named"
    assert verdict(sure, part, False).confidence > UNSURE


@pytest.mark.parametrize("other", [0.0, -6.0, -300.0])
def test_a_rival_that_is_worse_than_nothing_makes_no_name_surer(other):
    alone = verdict(played(contender("gas_spring", 7.6)), WHOLE, False)
    beside = played(contender("gas_spring", 7.6), contender("fluid_inertia", other, apart=0.1))
    assert verdict(beside, WHOLE, False).confidence == alone.confidence


def test_a_doubtful_class_of_several_families_is_not_asserted():
    one = played(
        contender("gas_spring", 30.0),
        contender("backlash", 29.0),
        contender("fluid_inertia", 26.0, apart=0.5),
    )
    part = Shares(ENOUGH, ENOUGH, 0.1)
    assert verdict(one, part, False).status is None
