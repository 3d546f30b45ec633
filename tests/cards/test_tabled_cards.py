"""Cards of the lumped model, whose parameters depend on the campaign's currents."""

import json
from typing import Any

import numpy as np
import pytest

from sysid.cards import read_card
from sysid.cards.check import check_vectors
from sysid.cards.idle import idle_effects
from sysid.cards.models import damper_of
from sysid.cards.schema import Card, Covariance, Parameter
from sysid.cards.verify import verify
from sysid.cards.write import card_text, write_card
from sysid.errors import CardError
from sysid.models.damper import Damper
from sysid.models.lumped import TABLE_1, Lumped
from sysid.motion.motion import sine_motion
from sysid.parameters import as_dict, build, specs
from tests.cards.example import example_card

AT_TWO: dict[str, float] = {s: v for s, v in TABLE_1.items() if "[" not in s} | {
    "C_post[0 A].intercept": 1400.0, "C_post[0 A].slope": -6.78,
    "C_post[0.75 A].intercept": 1700.0, "C_post[0.75 A].slope": -8.9,
    "F_y[0 A].intercept": 41.0, "F_y[0 A].slope": 0.19,
    "F_y[0.75 A].intercept": 1400.0, "F_y[0.75 A].slope": -5.0,
}  # fmt: skip


@pytest.fixture(scope="module")
def card() -> Card:
    valve, base = build(Lumped, AT_TWO), example_card()
    return base.model_copy(
        update={
            "model": "lumped",
            "variant": "paper",
            "parameters": tuple(
                Parameter(
                    symbol=s.symbol, name=s.name, value=AT_TWO[s.symbol], unit=s.unit,
                    sd=None, low=None, high=None, identified=True,
                )
                for s in specs(valve)
            ),
            "covariance": Covariance(symbols=(), matrix=()),
            "check": check_vectors(Damper(valve), base.validity),
        }
    )  # fmt: skip


def test_lines_come_back_from_the_file(card, tmp_path):
    path = tmp_path / "card.json"
    write_card(card, path)
    found = verify(read_card(path)).valve
    assert isinstance(found, Lumped)
    assert found.currents == (0.0, 0.75)
    assert as_dict(found) == AT_TWO
    write_card(read_card(path), tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == path.read_bytes()


def test_a_line_is_its_intercept_and_its_slope_times_degrees_celsius(card):
    raw = {p["symbol"]: p for p in json.loads(card_text(card))["parameters"]}
    low, slope = (raw[f"F_y[0.75 A].{end}"]["value"] for end in ("intercept", "slope"))
    valve = damper_of(card).valve
    assert isinstance(valve, Lumped)
    element = valve.element(sine_motion(0.01, 8.0, 0.75, 60.0, points=8))
    assert float(np.ravel(element.yielding)[0]) == pytest.approx(low + slope * 60.0, rel=1e-12)
    assert raw["k.slope"]["unit"] == "N/m/K"


def without(symbol: str):
    def change(raw: dict[str, Any]) -> None:
        raw["parameters"] = [p for p in raw["parameters"] if not p["symbol"].startswith(symbol)]

    return change


def renamed(old: str, new: str):
    def change(raw: dict[str, Any]) -> None:
        next(p for p in raw["parameters"] if p["symbol"] == old)["symbol"] = new

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (without("F_y[0.75 A].slope"), r"'lumped' lacks parameter F_y\[0.75 A\].slope"),
        (without("k."), r"'lumped' lacks parameters k.intercept, k.slope"),
        (
            lambda raw: [without(law)(raw) for law in ("F_y", "C_post")],
            r"parameters: model 'lumped' has parameters at some currents; this card names none",
        ),
        (
            renamed("F_y[0.75 A].slope", "F_y[0.750 A].slope"),
            r"has no parameter 'F_y\[0.750 A\].slope'.*C_post\[0.75 A\].intercept",
        ),
        (renamed("F_y[0.75 A].slope", "F_y[0.5 A].slope"), r"lacks parameters C_post\[0.5 A\].int"),
        (renamed("F_y[0.75 A].slope", "F_y[-1 A].slope"), r"has no parameter 'F_y\[-1 A\].slope'"),
        (renamed("F_y[0.75 A].slope", "F_y[1e999 A].slope"), r"has no parameter 'F_y\[1e999 A\]"),
    ],
)
def test_tables_with_holes_are_refused(card, tmp_path, change, message):
    raw = json.loads(card_text(card))
    change(raw)
    path = tmp_path / "card.json"
    path.write_text(json.dumps(raw))
    with pytest.raises(CardError, match=r"(?s)" + message):
        read_card(path)


def test_a_motion_without_temperature_is_told_which_one_is_taken(card):
    damper = damper_of(card)
    known, unknown = (sine_motion(0.01, 8.0, 0.75, t, points=8) for t in (60.0, None))
    assert idle_effects(damper, known) == ()
    (told,) = idle_effects(damper, unknown)
    assert told == "the temperature is not known: the model takes 40 °C"
    assert idle_effects(damper_of(example_card()), unknown) == ()
