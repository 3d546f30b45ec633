"""`sysid diagnose` as a user runs it; what it finds is tested elsewhere, and made by hand here."""

import json
import sys
from dataclasses import replace
from types import SimpleNamespace

import jsonschema
import numpy as np
import pytest

from sysid.cards import read_card
from sysid.cli import diagnosed
from sysid.cli.left_behind import left_behind
from sysid.diagnosis.diagnose import MOST
from sysid.report.diagnosis_schema import json_schema
from tests.report.made_diagnosis import named_backlash
from tests.report.made_page import Read

CONDITIONS = tuple(
    (a, f, i) for a, f in ((5.0, 1.0), (10.0, 1.0), (10.0, 2.0)) for i in (0.0, 0.2, 0.4)
)
FILES = {
    "diagnosis.json", "card.json", "before_after.png", "gain.png", "screen.png", "lack_of_fit.png",
}  # fmt: skip


@pytest.fixture
def campaign(make_campaign):
    return make_campaign(CONDITIONS)


@pytest.fixture
def asked(monkeypatch):
    """Put a diagnosis made by hand in the place of the real one; returns what it was asked."""
    asked = SimpleNamespace(loops=None, options=None, change=lambda d: d)

    def diagnose_loops(loops, **options):
        asked.loops, asked.options = loops, options
        return asked.change(named_backlash(loops))

    module = SimpleNamespace(diagnose_loops=diagnose_loops)
    monkeypatch.setitem(sys.modules, "sysid.diagnosis.diagnose", module)
    return asked


@pytest.fixture
def undrawn(monkeypatch):
    """Figures take most of the time; one test draws them."""
    monkeypatch.setattr(diagnosed, "figures", lambda d: {})


def test_an_answer_in_sentences_tables_and_files(campaign, asked, sysid, tmp_path):
    out = tmp_path / "out"
    said = sysid("diagnose", campaign, "-o", out, "--max-effects", 2, "--seed", 5)
    assert said.code == 0, said.err
    assert {p.name for p in out.iterdir()} == FILES | {"report.html"}  # which tells its command
    assert set(left_behind(out, ())) == FILES | {"report.html"}, "a later run knows all of them"
    first = said.out.splitlines()[0]
    assert first.startswith("At ")
    assert "lost motion (backlash), 0.41 ± 0.02 mm" in first
    assert said.out.index("the held-out error") < said.out.index("Causes")
    assert "delta: free play, whole gap" in said.out
    assert "load_cell_gain" in said.out
    assert "a dead weight" in said.out
    assert "priors were used" in said.err
    written = json.loads((out / "diagnosis.json").read_text())
    jsonschema.validate(written, json_schema())
    assert written["answer"] == "named"
    assert written["free_run"]["largest_deviation"] <= 1e-9
    card = read_card(out / "card.json")
    assert [e.id for e in card.effects] == ["backlash"]
    assert asked.options["models"] is None
    assert (asked.options["max_effects"], asked.options["seed"]) == (2, 5)
    assert asked.options["history"] is None
    assert len(asked.loops.ids) == 9

    again = tmp_path / "again"
    assert sysid("diagnose", campaign, "-o", again, "--quiet", "--max-effects", 2).err == ""
    for name in FILES:
        assert (again / name).read_bytes() == (out / name).read_bytes()


@pytest.mark.usefixtures("undrawn")
def test_as_many_effects_are_added_as_in_the_library(campaign, asked, sysid, tmp_path):
    assert sysid("diagnose", campaign, "-o", tmp_path / "out").code == 0
    assert asked.options["max_effects"] == MOST


@pytest.mark.usefixtures("undrawn")
def test_json_is_alone_on_stdout(campaign, asked, sysid, tmp_path):
    said = sysid("diagnose", campaign, "-o", tmp_path / "out", "--json")
    assert said.code == 0
    assert said.json == json.loads((tmp_path / "out" / "diagnosis.json").read_text())


@pytest.mark.usefixtures("undrawn")
def test_holdout_never_enters_and_is_reported(campaign, asked, sysid, tmp_path):
    said = sysid(
        "diagnose", campaign, "-o", tmp_path / "out", "--holdout", "10mm_2Hz_*",
        "--exclude", "5mm_1Hz_0A", "--json",
    )  # fmt: skip
    assert said.code == 0, said.err
    held = {f"10mm_2Hz_{i}A" for i in ("0", "0.2", "0.4")}
    assert len(asked.loops.ids) == 5
    assert not held & set(asked.loops.ids)
    assert {z["id"] for z in said.json["holdout"]} == held
    for z in said.json["holdout"]:
        assert z["nrmse_before"] > 0.05  # the damper of this campaign is another one
        assert z["nrmse_after"] != z["nrmse_before"]
    read = Read((tmp_path / "out" / "report.html").read_bytes())
    names = [t["id"] for t in json.loads(read.scripts["data"])["tests"]]
    cells = {names[int(c["data-test"])]: c for c in read.cells}
    assert len(cells) == 9
    for z in said.json["holdout"]:
        shown = list(map(float, cells[z["id"]]["data-errors"].split()))
        assert shown == [z["nrmse_before"], z["nrmse_after"]]
    assert "excluded by --exclude" in cells["5mm_1Hz_0A"]["aria-label"]
    assert list(said.json["left_out"]) == ["5mm_1Hz_0A"]
    assert "5mm_1Hz_0A is left out: excluded by --exclude" in said.err


@pytest.mark.usefixtures("undrawn")
def test_holding_everything_out_leaves_nothing(campaign, asked, sysid, tmp_path):
    said = sysid("diagnose", campaign, "-o", tmp_path / "out", "--holdout", "*")
    assert said.code == 1
    assert "no steady loop is left" in said.err
    assert not (tmp_path / "out").exists()


@pytest.mark.usefixtures("undrawn")
def test_the_base_comes_from_the_card_or_from_names(campaign, asked, sysid, tmp_path, card_file):
    out = tmp_path / "out"
    assert sysid("diagnose", campaign, "-o", out, "--card", card_file).code == 0
    assert asked.options["models"] == [("generalized", "symmetric")]
    said = sysid("diagnose", campaign, "-o", out, "--model", "dahl", "--model", "bouc_wen")
    assert said.code == 0
    assert asked.options["models"] == [("dahl", None), ("bouc_wen", None)]
    both = sysid("diagnose", campaign, "-o", out, "--card", card_file, "--model", "dahl")
    assert both.code == 2
    assert "not both" in both.err


@pytest.mark.usefixtures("undrawn")
def test_a_test_keeps_its_place_in_the_campaign_whichever_others_are_held_out(
    campaign, asked, sysid, tmp_path
):
    names = sorted(p.name for p in campaign.glob("*.csv"))
    rows = [f"{name},{k}" for k, name in enumerate(reversed(names), start=1)]
    (campaign / "tests.csv").write_text("\n".join(["file,run_order", *rows]) + "\n")
    last = names[0].removesuffix(".csv")
    out = ["-o", tmp_path / "out", "--holdout", last]
    assert sysid("diagnose", campaign, *out).code == 0
    share = [(8 - names.index(f"{name}.csv")) / 8 for name in asked.loops.ids]
    np.testing.assert_allclose(asked.options["history"].share, share)
    assert max(share) < 1.0


@pytest.mark.usefixtures("undrawn")
def test_a_card_that_says_something_else_is_not_to_be_trusted(campaign, asked, sysid, tmp_path):
    asked.change = lambda d: replace(d, simulated_after=d.simulated_after * (1 + 1e-8))
    said = sysid("diagnose", campaign, "-o", tmp_path / "out")
    assert said.code == 3
    assert "card.json does not give the forces of the diagnosed model" in said.err
    assert (tmp_path / "out" / "card.json").is_file()


@pytest.mark.usefixtures("undrawn")
def test_unknown_is_an_answer(campaign, asked, sysid, tmp_path):
    def unknown(d):
        rest = replace(d.unknown, present=True, share_of_reducible=0.9)
        return replace(
            d, answer="unknown", causes=(), gain=None, damper=d.base_damper, unknown=rest,
            simulated_after=d.simulated_before, symbols=d.symbols[:-1], values=d.values[:-1],
            covariance=d.covariance[:-1, :-1],
        )  # fmt: skip

    asked.change = unknown
    said = sysid("diagnose", campaign, "-o", tmp_path / "out")
    assert said.code == 0, said.err
    assert "No effect of the catalogue explains it." in said.out.splitlines()[0]
    assert read_card(tmp_path / "out" / "card.json").effects == ()


@pytest.mark.usefixtures("undrawn")
def test_where_no_base_will_do_the_untried_one_is_named(campaign, asked, sysid, tmp_path):
    asked.change = lambda d: replace(d, answer="base_inadequate")
    said = sysid("diagnose", campaign, "-o", tmp_path / "out")
    assert "--model lumped" in said.out
    said = sysid("diagnose", campaign, "-o", tmp_path / "one", "--model", "tanh")
    assert "--model lumped" not in said.out


def test_ctrl_c_leaves_nothing(campaign, asked, sysid, tmp_path):
    def stop(d):
        raise KeyboardInterrupt

    asked.change = stop
    said = sysid("diagnose", campaign, "-o", tmp_path / "out")
    assert said.code == 130
    assert "no result was written" in said.err
    assert "the same command begins anew" in said.err
    assert not (tmp_path / "out").exists()
    told = " ".join(sysid("diagnose", "--help").out.replace("│", " ").split())
    assert "stopped (Ctrl-C) leaves nothing, and the same command begins anew" in told


@pytest.mark.parametrize(("key", "value"), [("model", "foo"), ("variant", "bar")])
def test_a_card_of_an_unknown_model_is_named(key, value, campaign, asked, sysid, card_file):
    card = json.loads(card_file.read_text())
    card_file.write_text(json.dumps(card | {key: value}))
    said = sysid("diagnose", campaign, "-o", card_file.parent / "out", "--card", card_file)
    assert said.code == 1
    assert f"Error: {card_file}: {key} '{value}' is not known to this program" in said.err
    assert "it knows: " in said.err
    assert asked.loops is None


def test_bad_input_is_one_sentence(asked, sysid, tmp_path):
    said = sysid("diagnose", tmp_path / "nowhere", "-o", tmp_path / "out")
    assert said.code == 1
    assert said.err.startswith("Error: ")
    assert sysid("diagnose", tmp_path, "-o", tmp_path / "out", "--max-effects", 0).code == 2
