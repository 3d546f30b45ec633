"""`sysid compare`: several cards on the same tests."""

import json

import pytest

from sysid.cards.write import write_card
from sysid.effects.registry import effect_kind, make
from tests.cards.example import card_with
from tests.cli.test_validate import aged  # noqa: F401  # a fixture
from tests.report.made_page import Read


@pytest.fixture
def cards(aged, tmp_path):  # noqa: F811
    """The right card, one that lacks the drift, and the tests of the first."""
    card, campaign = aged
    bare = tmp_path / "bare.json"
    write_card(card_with(make(effect_kind("gas_spring"))), bare)
    return card, bare, campaign


def test_the_right_card_wins_and_the_page_shows_it(cards, sysid, tmp_path):
    right, bare, campaign = cards
    out = tmp_path / "out"
    said = sysid("compare", bare, right, "--on", campaign, "-o", out)
    assert said.code == 0, said.err
    assert {p.name for p in out.iterdir()} == {"report.html", "comparison.json"}
    told = json.loads((out / "comparison.json").read_text())
    assert told["best"] == str(right)
    means = {c["card"]: c["mean_nrmse"] for c in told["cards"]}
    assert means[str(right)] < 1e-3 < 0.02 < means[str(bare)]
    assert told["sentence"] in said.out
    read = Read((out / "report.html").read_bytes())
    assert told["sentence"] in read.text
    errors = {t["id"]: [t["nrmse"][str(c)] for c in (bare, right)] for t in told["tests"]}
    names = [t["id"] for t in json.loads(read.scripts["data"])["tests"]]
    for cell in read.cells:
        assert (
            list(map(float, cell["data-errors"].split())) == errors[names[int(cell["data-test"])]]
        )


def test_a_bar_has_the_colour_of_its_cards_curve(cards, sysid, tmp_path):
    right, bare, campaign = cards
    out = tmp_path / "out"
    assert sysid("compare", right, bare, bare, "--on", campaign, "-o", out).code == 0
    read = Read((out / "report.html").read_bytes())
    bars = [a["style"] for _, a in read.tags if a.get("class", "").startswith("stripe")][:3]
    curves = [look["color"] for look in json.loads(read.scripts["data"])["looks"]["models"]]
    assert [style.partition("background:")[2] for style in bars] == curves
    assert len(set(curves)) == 3


def test_json_is_alone_and_nothing_is_written(cards, sysid):
    right, bare, campaign = cards
    said = sysid("compare", right, bare, "--on", campaign, "--json")
    assert said.code == 0
    assert said.json["schema"] == "sysid-comparison-1"
    assert [c["outside"] for c in said.json["cards"]] == [0, 0]
    assert (said.json["trusted"], said.json["distrust"]) == (True, [])
    assert {t["id"] for t in said.json["tests"]} == {"t0", "t1", "t2"}


def test_outside_of_a_card_is_not_to_be_trusted(cards, sysid, make_campaign):
    right, bare, _ = cards
    campaign = make_campaign()
    said = sysid("compare", right, bare, "--on", campaign)
    assert said.code == 3
    assert "outside the validity" in said.err
    assert said.err.count("Do not trust") == 2
    told = sysid("compare", right, bare, "--on", campaign, "--json").json
    assert (told["trusted"], len(told["distrust"])) == (False, 2)


def test_one_card_is_no_comparison(cards, sysid):
    right, _, campaign = cards
    assert sysid("compare", right, "--on", campaign).code == 2
    twice = sysid("compare", right, right, "--on", campaign, "--json")
    assert [c["card"] for c in twice.json["cards"]] == [f"{right} (1)", f"{right} (2)"]
    assert "not told apart" in twice.json["sentence"]


def test_a_test_at_rest_stops_no_page(cards, sysid, tmp_path):
    """It is left out, with the amplitude of its name: none."""
    right, bare, campaign = cards
    rest = ["time_s,displacement_mm,force_N"] + [f"{k / 100},0,{k % 3}" for k in range(400)]
    (campaign / "0mm_0Hz_0A.csv").write_text("\n".join(rest) + "\n")
    said = sysid("compare", right, bare, "--on", campaign, "-o", tmp_path / "out")
    assert said.code == 0, said.err
    assert "0mm_0Hz_0A is left out" in said.err
    assert (tmp_path / "out" / "report.html").is_file()
