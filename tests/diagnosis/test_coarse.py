"""Selection where the base is far off: pairs that help only together, and where fits begin."""

import equinox as eqx
import numpy as np
import pytest

from sysid.data.loops import Loops
from sysid.diagnosis import coarse
from sysid.diagnosis.bases import Base, extendable
from sysid.diagnosis.contenders import SHAPE, Contender
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.ladder import LEAST_EVIDENCE
from sysid.diagnosis.scores import Scored
from sysid.diagnosis.selection import Selection
from sysid.diagnosis.state import State
from sysid.effects.registry import effect_kind, make
from sysid.identification.result import Fit
from sysid.likelihood.gls import GlsFit
from sysid.models.coordinates import place_of
from sysid.models.damper import Damper
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.parameters import as_dict, specs
from tests.diagnosis.bare import bare
from tests.models.rival_examples import example
from tests.models.test_rivals import coordinates_of

VALVE = coordinates_of("tanh")
TESTS = 20
Errors = dict[tuple[str, ...], float]


def state(*ids: str) -> State:
    effects = tuple(make(effect_kind(id)) for id in ids)
    gls = bare(GlsFit, u=np.zeros(0))
    return bare(State, coordinates=DamperCoordinates(VALVE, effects), gls=gls, likelihood=0.0)


def selected(monkeypatch, errors: Errors, most: int, gain: float = 9.0) -> Selection:
    """The rounds, where every set of effects has a given error on tests not seen."""
    offered = ("series_compliance", "seating_leakage", "gas_spring")
    known = {frozenset(ids): error for ids, error in errors.items()}

    def contenders(_, base, now, scores):
        ids = [id for id in offered if id not in now.ids and frozenset((*now.ids, id)) in known]
        scored = [bare(Scored, effect=make(effect_kind(id))) for id in ids]
        return tuple(
            Contender(s, state(*now.ids, id), gain - k)
            for k, (id, s) in enumerate(zip(ids, scored, strict=True))
        )

    best = min(errors, key=lambda ids: errors[ids])
    for name, stand_in in {
        "_of_the_damper": lambda campaign: campaign, "prototypes": lambda size: (),
        "score_candidates": lambda *_: (), "_contenders": contenders,
        "plainly_fitted": lambda *_: state(*best), "plain_distance": lambda *_: 0.0,
        "_unseen": lambda _, now: known[frozenset(now.ids)],
    }.items():  # fmt: skip
        monkeypatch.setattr(coarse, name, stand_in)
    campaign = bare(Evidence, size=None, loops=bare(Loops, ids=("a test",) * TESTS))
    return coarse.select_coarsely(campaign, state(), most=most, progress=lambda _: None)


TOGETHER: Errors = {
    (): 0.10, ("series_compliance",): 0.099, ("seating_leakage",): 0.10, ("gas_spring",): 0.10,
    ("series_compliance", "seating_leakage"): 0.06,
}  # fmt: skip


def test_two_that_help_only_together_are_found(monkeypatch):
    found = selected(monkeypatch, TOGETHER, most=4)
    first, second, last = found.rounds
    chosen = [r.contenders[0].id for r in (first, second)]
    assert chosen == ["series_compliance", "seating_leakage"]
    assert second.before is first.contenders[0].state
    assert last.contenders == ()
    assert found.kept == ("series_compliance", "seating_leakage")


def test_no_pair_is_taken_where_there_is_room_for_one_or_where_it_does_not_pay(monkeypatch):
    assert len(selected(monkeypatch, TOGETHER, most=1).rounds) == 1
    useless = TOGETHER | {("series_compliance", "seating_leakage"): 0.097}
    assert len(selected(monkeypatch, useless, most=4).rounds) == 1


def test_no_pair_is_sought_beside_a_spring_or_leak_that_is_there(monkeypatch):
    """Each of the others had its partner when it was tried."""
    errors: Errors = {
        (): 0.10, ("series_compliance",): 0.08, ("gas_spring",): 0.10,
        ("series_compliance", "seating_leakage"): 0.08,
        ("series_compliance", "gas_spring"): 0.08,
        ("series_compliance", "seating_leakage", "gas_spring"): 0.01,
    }  # fmt: skip
    assert len(selected(monkeypatch, errors, most=4).rounds) == 2


def test_what_gains_nothing_where_it_is_fitted_is_not_held_against_other_tests(monkeypatch):
    """To lower all errors by a twentieth takes 4.1 of log-likelihood in 20 tests."""
    assert coarse.worth_asking(TESTS) == pytest.approx(4.1 / 4, abs=0.01)
    errors: Errors = {(): 0.10, ("gas_spring",): 0.05}
    assert len(selected(monkeypatch, errors, most=2, gain=1.1).rounds) == 2
    assert len(selected(monkeypatch, errors, most=2, gain=0.9).rounds) == 1


def test_the_finalist_that_predicts_best_is_taken_be_another_likelier(monkeypatch):
    errors: Errors = {
        (): 0.10, ("series_compliance",): 0.11, ("seating_leakage",): 0.09, ("gas_spring",): 0.05,
    }  # fmt: skip
    found = selected(monkeypatch, errors, most=1)
    order = [c.id for c in found.rounds[0].contenders]
    assert order == ["gas_spring", "series_compliance", "seating_leakage"]


@pytest.mark.parametrize("id", ["series_compliance", "gas_spring"])
def test_a_second_spring_or_leak_also_begins_afresh(id):
    """From what the first alone had come to, and from its usual size beside the base's valve."""
    usual = make(effect_kind(id))
    size = usual.facts.size
    nominal = float(getattr(usual, size))
    grown = eqx.tree_at(lambda e: getattr(e, size), usual, 7.0 * getattr(usual, size))
    dampers = Damper(example("tanh")), Damper(example("tanh", alpha_b=2500.0), (grown,))
    base, now = (
        bare(State, coordinates=c, gls=bare(GlsFit, u=np.asarray(place_of(c, d))))
        for d in dampers
        if (c := DamperCoordinates(VALVE, tuple(usual for _ in d.effects)))
    )
    kept, *afresh = coarse._beginnings(base, now)
    assert as_dict(kept.effects[0])[size] == pytest.approx(7.0 * nominal)
    assert as_dict(kept.valve)["alpha_b"] == pytest.approx(2500.0)
    if id == "gas_spring":
        assert afresh == [], "what is linear needs no other start"
        return
    (fresh,) = afresh
    assert as_dict(fresh.effects[0])[size] == pytest.approx(nominal)
    assert as_dict(fresh.valve) == pytest.approx(as_dict(dampers[0].valve))


def bases(*described: tuple[str, float]) -> list[Base]:
    return [bare(Base, fit=bare(Fit, model=m), shapes=np.array([e])) for m, e in described]


def test_of_coarse_bases_one_without_memory_is_extended():
    ranked = bases(("bouc_wen", 0.094), ("dahl", 0.099), ("carreau", 0.11), ("tanh", 0.12))
    assert [b.fit.model for b in extendable(ranked, coarse=True)] == ["carreau"]
    assert [b.fit.model for b in extendable(ranked, coarse=False)] == ["bouc_wen", "dahl"]
    far = bases(("bouc_wen", 0.08), ("carreau", 0.2))
    assert [b.fit.model for b in extendable(far, coarse=True)] == ["bouc_wen"], "not admissible"


def test_what_is_of_no_use_beside_a_spring_or_leak_is_not_tried_again():
    """By itself nothing is given up: it may need the other."""
    gains = {"seating_leakage": 14.0, "backlash": 0.5, "gas_spring": 0.1}
    tried = [
        Contender(bare(Scored, effect=make(effect_kind(id))), state(id), gain)
        for id, gain in gains.items()
    ]
    assert coarse._useless(state("gas_spring"), tried) == frozenset()
    left = coarse._useless(state("series_compliance"), tried)
    assert "backlash" in left
    assert {"seating_leakage", "gas_spring"}.isdisjoint(left), "useful, or quickly tried"


def test_a_leak_that_another_fault_hid_is_tried_again_once_nothing_else_pays(monkeypatch):
    gains = {
        (): {"series_compliance": 60.0},
        ("series_compliance",): {"gas_spring": 50.0, "bypass_leakage": 1.0},
        ("series_compliance", "gas_spring"): {"bypass_leakage": 40.0, "backlash": 0.5},
        ("series_compliance", "gas_spring", "bypass_leakage"): {"backlash": 0.5},
    }
    errors = {ids: 0.2 / 2 ** len(ids) for ids in gains}
    asked = []

    def contenders(_, base, now, scores):
        offered = {s.effect.facts.id for s in scores}
        asked.append((now.ids, "bypass_leakage" in offered))
        return tuple(
            Contender(bare(Scored, effect=make(effect_kind(id))), state(*now.ids, id), gain)
            for id, gain in gains[now.ids].items()
            if id in offered
        )

    every = ("series_compliance", "gas_spring", "bypass_leakage", "backlash")
    for name, stand_in in {
        "_of_the_damper": lambda campaign: campaign,
        "prototypes": lambda size: tuple(make(effect_kind(id)) for id in every),
        "score_candidates": lambda _, now, some: tuple(bare(Scored, effect=e) for e in some),
        "_contenders": contenders,
        "plainly_fitted": lambda _, own, u: state(*(e.facts.id for e in own.prototypes)),
        "plain_distance": lambda _, chosen, other: 0.0 if other.ids == chosen.ids else 7.0,
        "_unseen": lambda _, now: errors.get(now.ids, 1.0),
    }.items():  # fmt: skip
        monkeypatch.setattr(coarse, name, stand_in)
    loops = bare(Loops, ids=("a test",) * TESTS)
    campaign = bare(Evidence, size=None, loops=loops, history=None)
    found = coarse.select_coarsely(campaign, state(), most=8, progress=lambda _: None)
    assert found.kept == ("series_compliance", "gas_spring", "bypass_leakage")
    beside_both = [offered for ids, offered in asked if ids == ("series_compliance", "gas_spring")]
    assert beside_both == [False, True]  # laid aside at first
    assert [r.contenders[0].id for r in found.rounds[:-1]] == list(found.kept)
    apart = [[c.apart for c in r.contenders] for r in found.rounds]
    assert apart == [[0.0], [0.0, 7.0], [0.0, 7.0], []]
    assert len(asked) < 10  # and it ends


def test_every_further_parameter_has_to_pay(monkeypatch):
    """An end stop is a gas spring with one more; without that they would be 5 apart."""
    likelihoods = {"gas_spring": 29.0, "bump_stop": 34.0}

    def fitted(_, own: DamperCoordinates, *__) -> State:
        (effect,) = own.prototypes
        gls = bare(GlsFit, u=np.zeros(1 + len(specs(effect))))
        return bare(State, gls=gls, likelihood=likelihoods[effect.facts.id])

    monkeypatch.setattr(coarse, "plainly_fitted", fitted)
    campaign = bare(Evidence)
    before = bare(State, gls=bare(GlsFit, u=np.zeros(1)), likelihood=0.0)
    gains = {}
    for id in likelihoods:
        own = DamperCoordinates(VALVE, (make(effect_kind(id)),))
        one = coarse._tried(campaign, before, bare(Scored), own, np.zeros(0), coarse.QUICK)
        assert one is not None
        gains[id] = one.gain
    assert gains == {"gas_spring": 29.0, "bump_stop": 34.0 - SHAPE}
    assert gains["gas_spring"] > gains["bump_stop"] - LEAST_EVIDENCE
