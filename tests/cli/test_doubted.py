"""A card of a result that must not be trusted is not used without a word."""

import json
import zipfile
from xml.etree import ElementTree

import pytest

from sysid.cards.doubts import doubts
from sysid.cards.write import write_card
from tests.cards.example import card_with
from tests.cli.test_validate import aged  # noqa: F401  # a fixture

(DOUBT,) = doubts(["it did not converge"])
SINE = ["--amplitude", "12.5mm", "--frequency", "1.5Hz", "--current", "0.2A"]
QUICK = ["--motions", "1", "--draws", "0", "--duration", "0.2s", "--controller", "P"]


@pytest.fixture(scope="module")
def doubted(tmp_path_factory):
    path = tmp_path_factory.mktemp("doubted") / "card.json"
    card = card_with()
    write_card(
        card.model_copy(update={"known_discrepancies": (*card.known_discrepancies, DOUBT)}), path
    )
    return path


@pytest.mark.parametrize(
    "order",
    [
        ["simulate", "CARD", *SINE, "-o", "DIR/f.csv"],
        ["validate", "CARD", "CAMPAIGN"],
        ["compare", "CARD", "CARD", "--on", "CAMPAIGN", "-o", "DIR"],
        ["export", "CARD", "--to", "c", "-o", "DIR/d.c"],
        ["export", "CARD", "--to", "csv", "-o", "DIR/d.csv"],
        ["isolator", "CARD", "-o", "DIR", *QUICK],
    ],
    ids=lambda order: " ".join(order[:4:3]),
)
def test_every_command_warns_and_notes_it(order, doubted, aged, sysid, tmp_path):  # noqa: F811
    places = {"CARD": str(doubted), "CAMPAIGN": str(aged[1])}
    words = [places.get(z, z.replace("DIR", str(tmp_path))) for z in order]
    said = sysid(*words, "--json", "--quiet")
    assert f"Warning: {doubted}" in said.err
    assert DOUBT in said.err
    assert any(note.endswith(DOUBT) for note in said.json["notes"])
    for name in ("isolator.json", "comparison.json"):
        if (tmp_path / name).exists():
            assert json.loads((tmp_path / name).read_text())["notes"] == said.json["notes"]


def test_an_fmu_says_so_where_simulators_show_it(doubted, sysid, tmp_path):
    said = sysid("export", doubted, "--to", "fmu", "-o", tmp_path / "d.fmu")
    assert said.code == 0, said.err
    text = zipfile.ZipFile(tmp_path / "d.fmu").read("modelDescription.xml")
    assert DOUBT in ElementTree.fromstring(text).attrib["description"]


def test_a_card_that_may_be_trusted_is_used_without_a_word(card_file, sysid, tmp_path):
    said = sysid("simulate", card_file, *SINE, "-o", tmp_path / "f.csv", "--json")
    assert "Warning" not in said.err
    assert said.json["notes"] == []
