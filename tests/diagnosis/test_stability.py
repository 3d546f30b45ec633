"""Half of the tests come to the same effect where all speak for it, not where a few do."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.diagnosis.contenders import Contender, Round
from sysid.diagnosis.evidence import Evidence, gather
from sysid.diagnosis.judged import kin, steadied
from sysid.diagnosis.ladder import Verdict
from sysid.diagnosis.plain import NONE
from sysid.diagnosis.scores import Scored
from sysid.diagnosis.stability import STEADY, least_of_half, stability, wins
from sysid.diagnosis.state import State
from sysid.effects.registry import effect_kind, make
from sysid.identification.problem import loop_problem
from sysid.likelihood.discrepancy import Covariance, Sizes
from sysid.likelihood.gls import GlsFit
from sysid.likelihood.reml import Restricted
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.models.generalized_coordinates import GeneralizedCoordinates
from tests.diagnosis.test_lack_of_fit import campaign

SIZES = Sizes(gain=1e-3, offset=0.5, delay=1e-6)
CURVES = {
    "gas_spring": lambda loops: loops.displacement,
    "fluid_inertia": lambda loops: loops.acceleration,
    "position_friction": lambda loops: loops.displacement * np.sign(loops.velocity),
}


def played(added, sizes: Sizes = SIZES, noise: float = 5.0) -> tuple[Evidence, Round]:
    """A round in which springs, masses and friction were fitted, by linear least squares."""
    loops = campaign(
        lambda x, v, a, A, f, i: 1000 * np.tanh(v / 0.01) + added(x, v, a, A, f), noise=noise
    )
    evidence = gather(loops)
    compress = evidence.basis.compress
    valve = compress(np.tanh(loops.velocity / 0.01))
    coordinates = GeneralizedCoordinates(loop_problem(loops).reference, "symmetric")
    covariance = Covariance(evidence.parts, sizes)

    def state(*curves: np.ndarray) -> State:
        jacobian = np.stack([valve, *curves], axis=2)
        both = np.concatenate([jacobian, evidence.measured[:, :, None]], axis=2)
        gram = covariance.inner(both, both)
        u = np.linalg.solve(gram[:-1, :-1], gram[:-1, -1])
        residual = evidence.measured - jacobian @ u
        cost = float(gram[-1, -1] - u @ gram[:-1, -1])
        gls = GlsFit(u, cost, residual, jacobian, gram[:-1, :-1], 1, True)
        likelihood = -0.5 * (covariance.log_determinant + cost)
        return State(
            DamperCoordinates(coordinates, ()),
            gls,
            Restricted(sizes, covariance, 0.0, np.zeros(8)),
            likelihood,
        )

    before, contenders = state(), []
    for id, curve in CURVES.items():
        signature = compress(curve(loops))
        fitted = state(signature)
        scored = Scored(make(effect_kind(id)), 400.0, 14.0, 0.5, 1.0, 0.05, signature)
        contenders.append(Contender(scored, fitted, fitted.likelihood - before.likelihood))
    contenders.sort(key=lambda c: -c.gain)
    return evidence, Round(before, tuple(c.scored for c in contenders), tuple(contenders))


def test_what_all_tests_show_wins_in_every_half():
    evidence, one = played(lambda x, v, a, A, f: 3000 * x)
    assert one.contenders[0].id == "gas_spring"
    assert wins(evidence, one) == {
        "gas_spring": 1.0,
        "fluid_inertia": 0.0,
        "position_friction": 0.0,
    }
    assert stability(evidence, one, ("gas_spring",)) == 1.0


def test_what_one_condition_shows_is_lost_where_it_is_missing():
    """A friction that one stroke alone has: the halves without that stroke do not find it."""
    strange = lambda x, v, a, A, f: np.where(np.isclose(A, 0.05), 2000 * x * np.sign(v), 0.0)  # noqa: E731
    evidence, one = played(strange)
    assert one.contenders[0].id == "position_friction"
    assert one.contenders[0].gain > 100.0
    assert stability(evidence, one, ("position_friction",)) == pytest.approx(0.5, abs=0.02)


def test_nothing_wins_where_nothing_is():
    evidence, one = played(lambda x, v, a, A, f: 0.0 * x)
    assert sum(wins(evidence, one).values()) < 0.1


def test_members_of_a_class_count_together():
    evidence, one = played(lambda x, v, a, A, f: 3000 * x)
    assert stability(evidence, one, ("gas_spring", "fluid_inertia")) == 1.0
    assert stability(evidence, one, ("fluid_inertia",)) == 0.0


NAME, FAMILY = (Verdict(s, (), 0.7) for s in ("named", "family"))


def verdicts(one: Round) -> tuple[Verdict, Verdict]:
    """That of all tests, and the weaker one."""
    members = (one.contenders[0].id,)
    return replace(NAME, members=members), replace(FAMILY, members=members)


def test_what_halves_come_to_stays_a_name():
    evidence, one = played(lambda x, v, a, A, f: 3000 * x)
    assert steadied(evidence, one, *verdicts(one)) == Verdict("named", ("gas_spring",), 0.7, 1.0)


def test_a_family_that_halves_do_not_come_to_is_not_asserted():
    strange = lambda x, v, a, A, f: np.where(np.isclose(A, 0.05), 2000 * x * np.sign(v), 0.0)  # noqa: E731
    evidence, one = played(strange)
    found = steadied(evidence, one, *verdicts(one))
    assert (found.status, found.confidence) == (None, 0.0)
    assert found.stability == pytest.approx(0.5, abs=0.02)
    name = verdicts(one)[0]
    assert steadied(evidence, one, name, name).status == "named", "where halves do not count"


def test_halves_that_come_to_one_kin_or_another_leave_the_family():
    """A spring of long strokes and a mass of fast ones, each about as strong."""
    mixed = lambda x, v, a, A, f: np.where(A > 0.02, 600 * x, 1.5 * a)  # noqa: E731
    evidence, one = played(mixed)
    assert set(kin(one)) == {"gas_spring", "fluid_inertia"}
    found = steadied(evidence, one, *verdicts(one))
    assert found.stability < STEADY
    assert found.status == "family"


def test_which_of_two_effects_comes_first_does_not_matter_where_both_are_needed():
    """Friction that is stronger in long strokes, a spring that is stronger in short ones."""
    spring, friction = "gas_spring", "position_friction"
    evidence, one = played(
        lambda x, v, a, A, f: (
            x * np.where(A > 0.02, 600.0, 3000.0) + x * np.sign(v) * np.where(A > 0.02, 1200, 600)
        )
    )
    two = replace(one, contenders=tuple(c for c in one.contenders if c.id in (friction, spring)))
    assert two.contenders[0].id == friction
    assert stability(evidence, two, (friction,)) < STEADY
    assert stability(evidence, two, (friction,), (friction, spring)) == 1.0
    assert steadied(evidence, two, *verdicts(two)).status is None
    assert steadied(evidence, two, *verdicts(two), (friction, spring)).status == "named"


def test_plain_fits_are_compared_by_the_size_of_their_errors():
    """Where the base is far off, Σ has no sizes, and likelihoods are those of unknown errors."""
    evidence, one = played(lambda x, v, a, A, f: 3000 * x, NONE)
    assert wins(evidence, one)["gas_spring"] > 0.9


def test_the_order_of_the_tests_does_not_matter():
    strange = lambda x, v, a, A, f: np.where(A > 0.02, 600 * x * np.sign(v), 0.0)  # noqa: E731
    evidence, one = played(strange)
    renamed = replace(evidence, condition=evidence.condition.max() - evidence.condition)
    assert wins(renamed, one) == wins(evidence, one)


def test_too_few_conditions_say_nothing():
    evidence, one = played(lambda x, v, a, A, f: 3000 * x)
    few = replace(evidence, condition=evidence.condition % 4)
    assert wins(few, one) == {}
    assert np.isnan(stability(few, one, ("gas_spring",)))


@pytest.mark.parametrize(
    ("part", "low", "high"),
    [
        pytest.param(1.0, STEADY - 0.03, STEADY + 0.03, id="just suffices"),
        pytest.param(0.5, 0.0, 0.6, id="half as probable"),
        pytest.param(3.0, 0.98, 1.0, id="three times"),
    ],
)
def test_what_just_suffices_on_all_tests_wins_its_share_of_halves(part, low, high):
    """Conditions that all speak alike, each with its noise, and a total that is as said."""
    least, conditions = 7.5, 30
    rng = np.random.default_rng(4)
    won = []
    for _ in range(400):
        said = rng.normal(size=conditions)
        said += (np.sqrt(2.0 * part * least * conditions) - said.sum()) / conditions
        half = rng.permutation(conditions)[: conditions // 2]
        won.append(0.5 * said[half].sum() ** 2 / half.size > least_of_half(least))
    assert low <= np.mean(won) <= high
