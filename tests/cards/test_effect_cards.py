"""Cards that carry effects: read back to the same force, refused where an effect is not right."""

import json
from functools import cache

import jsonschema
import numpy as np
import pytest

from sysid.cards import read_card, write_card
from sysid.cards.check import check_motion
from sysid.cards.idle import idle_effects
from sysid.cards.models import damper_of, effect_prefixes
from sysid.cards.schema import Card, Check, json_schema
from sysid.cards.verify import verify
from sysid.cards.write import card_text
from sysid.effects.registry import EFFECTS, choices, effect_kind, make
from sysid.errors import CardError
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.models.simulate import simulate
from sysid.motion.history import RunHistory, with_history
from sysid.motion.motion import Motion, sine_motion
from sysid.parameters import as_dict, build
from tests.cards.example import card_with

VALVE = build(Generalized, LOW_SYMMETRIC)
FORMS = [(kind, choice) for kind in EFFECTS for choice in choices(kind)]
ON_RECORD = with_history(
    sine_motion(0.01, 1.0, 0.2, np.array([40.0])),
    RunHistory(np.zeros(1), np.zeros(1)),
    cycle=np.zeros(1),
)
each_form = pytest.mark.parametrize(
    ("kind", "choice"),
    FORMS,
    ids=["-".join([k.facts.id, *(str(v) for v in c.values())]) for k, c in FORMS],
)


SEES_NOTHING = {"displacement_zero", "bump_stop"}
"""The valve does not know its place; the stops are beyond this stroke."""


@cache
def loops() -> Motion:
    a, f, i, t = np.array([[0.0125, 0.0125], [0.5, 5.0], [0.1, 0.4], [34.0, 47.0]])
    return sine_motion(a, f, i, t, points=72)


@each_form
def test_card_reads_back_to_the_same_force(kind, choice, tmp_path):
    effect = make(kind, choice=choice)
    card = card_with(effect)
    write_card(card, tmp_path / "card.json")
    read = read_card(tmp_path / "card.json", check=False)
    assert read == card
    damper = verify(read)
    expected = np.asarray(simulate(Damper(VALVE, (effect,)), loops()))
    np.testing.assert_allclose(
        simulate(damper, loops()), expected, rtol=0.0, atol=1e-9 * np.abs(expected).max()
    )
    assert_idleness_is_told(damper, read.check[-1])


def assert_idleness_is_told(damper: Damper, check: Check) -> None:
    """Without frequency, temperature and history an effect has a say unless told otherwise."""
    motion = check_motion(check.model_copy(update={"temperature": ()}))
    told = idle_effects(damper, motion)
    added = np.abs(simulate(damper, motion) - simulate(Damper(VALVE), motion)).max()
    assert (added < 1e-9) == bool(told) or damper.effects[0].facts.id in SEES_NOTHING
    assert idle_effects(damper, ON_RECORD) == ()


def test_effects_act_in_the_order_of_the_card(tmp_path):
    """A gain behind an offset is not an offset behind a gain."""
    offset, gain = (make(effect_kind(id)) for id in ("force_offset", "load_cell_gain"))
    forces = []
    for effects in ((offset, gain), (gain, offset)):
        write_card(card_with(*effects), tmp_path / "card.json")
        damper = verify(read_card(tmp_path / "card.json", check=False))
        assert [e.facts.id for e in damper.effects] == [e.facts.id for e in effects]
        forces.append(np.asarray(simulate(damper, loops())))
    share, size = as_dict(gain)["g_c"], as_dict(offset)["F_off"]
    np.testing.assert_allclose(forces[0] - forces[1], share * size, atol=1e-9)


def test_choice_is_written_only_where_there_is_one():
    card = card_with(make(effect_kind("gas_spring")), make(effect_kind("entrained_air")))
    plain, chosen = json.loads(card_text(card))["effects"]
    assert list(plain) == ["id", "stage", "parameters"]
    assert list(chosen) == ["id", "stage", "choice", "parameters"]
    assert chosen["choice"] == {"side": 1}
    jsonschema.validate(json.loads(card_text(card)), json_schema())


def test_two_forms_of_one_effect_keep_their_names():
    kind = effect_kind("frequency_law")
    first, second = (
        make(kind, size, {"part": p}) for size, p in ((0.05, "yield"), (0.02, "whole"))
    )
    assert effect_prefixes(["frequency_law", "gas_spring", "frequency_law"]) == (
        "frequency_law.", "gas_spring.", "frequency_law-2.",
    )  # fmt: skip
    raw = json.loads(card_text(card_with(first)))
    other = json.loads(card_text(card_with(second)))["effects"][0]
    other["parameters"][0]["symbol"] = "frequency_law-2.eps_f"
    raw["effects"].append(other)
    damper = damper_of(Card.model_validate(raw, by_alias=True, by_name=False))
    assert [as_dict(e)["eps_f"] for e in damper.effects] == [0.05, 0.02]
    assert [vars(e)["part"] for e in damper.effects] == ["yield", "whole"]


def gas(**changes):
    """One entry of `effects`, spoilt."""
    raw = json.loads(card_text(card_with(make(effect_kind("gas_spring")))))["effects"][0]
    return {**raw, **changes}


def air(**changes):
    raw = json.loads(card_text(card_with(make(effect_kind("entrained_air")))))["effects"][0]
    return {**raw, **changes}


def spoilt(**changes):
    """The parameter of a gas spring, spoilt."""
    return gas(parameters=[{**gas()["parameters"][0], **changes}])


BAD = {
    "unknown": (gas(id="gas_sprong"), r"\.id: effect 'gas_sprong' is not known .*knows: gas_sprin"),
    "very unknown": (gas(id="dust"), r"\.id: effect 'dust' is not known .*Update sysid"),
    "stage": (gas(stage="channel"), r"\.stage: effect 'gas_spring' acts at stage 'force', not"),
    "no stage": (gas(stage="rig"), r"\.stage: \"rig\" is refused"),
    "missing": (gas(parameters=[]), r"\.parameters: effect 'gas_spring' lacks parameter gas"),
    "foreign": (
        spoilt(symbol="gas_spring.k"), r"\.parameters\[0\]\.symbol: effect 'gas_spring' has no",
    ),
    "without its id": (spoilt(symbol="k_g"), r"\.parameters\[0\]\.symbol: .* has no parameter 'k_"),
    "unit": (
        spoilt(unit="N/mm"), r"\.parameters\[0\]\.unit: the unit of gas_spring\.k_g is N/m, not N/",
    ),
    "text": (spoilt(value="1500"), r"\.parameters\[0\]\.value: \"1500\" is refused"),
    "bounds": (
        air(parameters=[{**air()["parameters"][0], "value": -1e-4}]),
        r"\.parameters\[0\]\.value: delta_a = -0.0001 m is outside",
    ),
    "choice where none is": (gas(choice={"side": 1}), r"\.choice: .* has no form side = 1.*with"),
    "no such choice": (air(choice={"side": 2}), r"\.choice: .*has no form side = 2.*side = 1"),
    "choice left out": (air(choice={}), r"\.choice: .*has no form with a choice left out"),
    "choice is true": (air(choice={"side": True}), r"\.choice\.side.*: true is refused"),
    "choice is text": (air(choice={"side": "1"}), r"\.choice: .*has no form"),
    "unknown key": (gas(colour="red"), r"\.colour: this key is not known"),
}  # fmt: skip


@pytest.mark.parametrize("kind", BAD)
def test_wrong_effects_are_refused_with_file_and_place(kind, raw, tmp_path):
    entry, message = BAD[kind]
    raw["effects"] = [entry]
    (tmp_path / "card.json").write_text(json.dumps(raw))
    with pytest.raises(CardError, match=r"card\.json, effects\[0\]" + message):
        read_card(tmp_path / "card.json")


def test_an_effect_twice_is_refused(raw, tmp_path):
    raw["effects"] = [gas(), gas()]
    (tmp_path / "card.json").write_text(json.dumps(raw))
    with pytest.raises(CardError, match=r"parameter gas_spring\.k_g stands there twice"):
        read_card(tmp_path / "card.json")


def test_an_altered_effect_is_found_by_the_check_vectors(tmp_path):
    raw = json.loads(card_text(card_with(make(effect_kind("gas_spring")))))
    raw["effects"][0]["parameters"][0]["value"] += 0.001
    (tmp_path / "card.json").write_text(json.dumps(raw))
    with pytest.raises(CardError, match=r"check\[0\]\.force_N\[\d+\]: does not reproduce"):
        read_card(tmp_path / "card.json")
