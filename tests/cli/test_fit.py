"""`sysid fit` and `sysid validate` as a user runs them, on a shipped virtual campaign."""

import json
import shutil
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from sysid.cards import read_card
from sysid.cards.models import damper_of
from sysid.cards.schema import json_schema
from sysid.cli.app import run
from sysid.cli.options import VARIANTS, Model
from sysid.data.campaign import load_campaign
from sysid.diagnosis.words import percent
from sysid.identification.multistart import Minimum
from sysid.identification.result import Result
from sysid.models.simulate import simulate
from sysid.motion.motion import sine_motion
from tests.cli.shipped import DATASETS, LOW, some_tests
from tests.report.made_page import Read
from tests.structure.result_keys import missing, written

FILES = {"card.json", "fit.json", "loops.png", "report.html", "worst.png"}
HELD = "12.5mm_2.5Hz_*"


@pytest.fixture(scope="module")
def fitted(tmp_path_factory) -> Path:
    """A fit of 20 loops, five of them held out."""
    out = tmp_path_factory.mktemp("fit") / "Dämpfer 阻尼"
    order = ["fit", LOW, "-o", out, "--variant", "symmetric", "--holdout", HELD, "--quiet"]
    assert run([*map(str, order), "--no-posterior"]) == 0
    assert {p.name for p in out.iterdir()} == FILES
    return out


def test_the_page_shows_the_errors_of_fit_json(fitted):
    fit = json.loads((fitted / "fit.json").read_text())
    read = Read((fitted / "report.html").read_bytes())
    names = [t["id"] for t in json.loads(read.scripts["data"])["tests"]]
    shown = {names[int(c["data-test"])]: c for c in read.cells}
    assert sorted(shown) == sorted(t["id"] for t in fit["tests"])
    for test in fit["tests"]:
        cell = shown[test["id"]]
        assert float(cell["data-errors"]) == test["nrmse"]
        assert ("held out" in cell["aria-label"]) == ("held" in cell["class"]) == test["held_out"]
    for key in ("mean_nrmse", "held_out_mean_nrmse"):
        assert percent(fit["summary"][key]) in read.text
    card = read_card(fitted / "card.json")
    for parameter in card.parameters:
        assert parameter.symbol in read.text
        if parameter.identified:
            assert f"{parameter.value:.5g}".replace("-", "−") in read.text
    for file in card.data:
        assert file.sha256 in read.text
    assert f"sysid fit {LOW} -o" in read.text


def test_a_test_that_the_others_contradict_is_told_with_what_it_looks_like(sysid, tmp_path):
    """The recorded current of one of twenty tests is that of another."""
    odd = "12.5mm_1.5Hz_0.3A"
    campaign = tmp_path / "campaign"
    shutil.copytree(LOW, campaign, ignore=shutil.ignore_patterns("sealed", "README.md"))
    lines = (campaign / f"{odd}.csv").read_text().splitlines()
    k = lines[0].split(",").index("current_A")
    rows = [[*row[:k], "0.100", *row[k + 1 :]] for row in (z.split(",") for z in lines[1:])]
    text = "\n".join([lines[0], *map(",".join, rows)])
    (campaign / f"{odd}.csv").write_text(text + "\n")
    out = tmp_path / "out"
    said = sysid("fit", campaign, "-o", out, "--variant", "symmetric", "--quiet")
    assert said.code == 0
    (told,) = [z for z in said.err.splitlines() if "does not agree" in z]
    assert told.startswith(f"Warning: {odd} does not agree with the other 19 tests")
    assert "A instead of 0.1 A" in told
    assert told.endswith("--exclude leaves it out.")
    sentence = told.removeprefix("Warning: ").split(" Look at")[0]
    assert sentence in json.loads((out / "fit.json").read_text())["notes"]
    assert sentence in read_card(out / "card.json").known_discrepancies
    assert "does not agree with the other 19 tests" in Read((out / "report.html").read_bytes()).text


def test_fit_json_is_that_of_the_contract(fitted):
    fit = json.loads((fitted / "fit.json").read_text())
    head = {key: fit[key] for key in ("schema", "model", "variant", "weights", "result")}
    assert head == {
        "schema": "sysid-fit-1", "model": "generalized", "variant": "symmetric",
        "weights": "paper", "result": "converged",
    }  # fmt: skip
    assert len(fit["tests"]) == 20
    assert {t["id"] for t in fit["tests"] if t["held_out"]} == {
        f"12.5mm_2.5Hz_{i}A" for i in ("0", "0.1", "0.2", "0.3", "0.4")
    }
    for test in fit["tests"]:
        assert test["used"] != test["held_out"]
        assert test["why_not"] is None
        assert 0 < test["nrmse"] < 0.02
        assert 98 < test["fit_percent"] < 100
    used = [t["nrmse"] for t in fit["tests"] if t["used"]]
    held = [t["nrmse"] for t in fit["tests"] if t["held_out"]]
    assert fit["summary"]["mean_nrmse"] == pytest.approx(np.mean(used))
    assert fit["summary"]["held_out_mean_nrmse"] == pytest.approx(np.mean(held))
    assert fit["summary"]["starts"] > 1
    assert fit["summary"]["basins"] >= 1
    assert fit["summary"]["cost"] > 0


def test_every_key_stands_on_the_page_of_keys(fitted, sysid):
    assert missing(written(json.loads((fitted / "fit.json").read_text())), "fit.json") == []
    found = sysid("validate", fitted / "card.json", LOW, "--json").json
    assert missing(written(found), "sysid validate") == []


def test_the_card_holds_the_campaign(fitted):
    raw = json.loads((fitted / "card.json").read_text())
    jsonschema.validate(raw, json_schema())
    card = read_card(fitted / "card.json")
    fit = json.loads((fitted / "fit.json").read_text())
    used = {t["id"] for t in fit["tests"] if t["used"]}
    hashes = {r.source.file: r.source.sha256 for r in load_campaign(LOW).records if r.id in used}
    assert len(hashes) == 15
    assert {d.file: d.sha256 for d in card.data} == hashes, "held-out tests identified nothing"
    assert card.validity.amplitude == pytest.approx((0.0125, 0.0125), rel=0.02)
    assert card.validity.frequency == pytest.approx((0.5, 5.0), rel=0.02)
    assert card.validity.current == pytest.approx((0.0, 0.4), abs=0.01)
    assert card.validity.velocity == pytest.approx((0.0, 0.393), rel=0.03)
    assert card.values()["F_0"] == pytest.approx(68.5, rel=0.05)
    assert card.values()["k_5"] == 0.0
    assert "Eq. 11 under errors of rig and laws" in card.interval
    told = " ".join(card.known_discrepancies)
    assert "The largest error is in 12.5mm_" in told
    assert "No test was held out" not in told
    assert (fit["trusted"], fit["distrust"]) == (True, [])
    assert "must not be trusted" not in told
    assert card.quality.mean_nrmse == fit["summary"]["mean_nrmse"]
    assert set(fit["undetermined"]) <= set(card.known_discrepancies)


def test_how_well_a_cycle_and_the_mean_cycle_repeat_are_two_numbers(fitted, sysid):
    """The second is the smaller; what a perfect model would leave is that one."""
    found = sysid("check", LOW, "--json").json["tests"]
    checked = {t["id"]: (t["noise_floor_N"], t["cycles"], t["peak_force_N"]) for t in found}
    fit = json.loads((fitted / "fit.json").read_text())
    shares = []
    for test in fit["tests"]:
        single, cycles, peak = checked[test["id"]]
        assert test["noise_floor_N"] == pytest.approx(single, rel=1e-9)
        assert test["mean_cycle_noise_N"] == pytest.approx(single / np.sqrt(cycles), rel=1e-9)
        if test["used"]:
            shares.append((single / peak, single / np.sqrt(cycles) / peak))
    quality = read_card(fitted / "card.json").quality
    of_one, of_mean = np.mean(shares, axis=0)
    assert quality.noise_floor_nrmse == pytest.approx(of_one, rel=0.02)  # by the record's peak
    assert quality.mean_cycle_noise_nrmse == pytest.approx(of_mean, rel=0.02)
    assert of_mean < 0.5 * of_one
    said = sysid("validate", fitted / "card.json", LOW)
    assert "noise of the mean cycle" in said.out
    worst = max(fit["tests"], key=lambda t: t["nrmse"])
    row = next(z for z in said.out.splitlines() if worst["id"] in z)
    assert f"{worst['mean_cycle_noise_N']:.3g}" in row
    assert f"{worst['noise_floor_N']:.3g}" not in row


def test_a_card_of_before_the_second_number_is_read(fitted, tmp_path):
    raw = json.loads((fitted / "card.json").read_text())
    del raw["quality"]["mean_cycle_noise_nrmse"]
    (tmp_path / "old.json").write_text(json.dumps(raw))
    jsonschema.validate(raw, json_schema())
    assert read_card(tmp_path / "old.json").quality.mean_cycle_noise_nrmse is None


def test_how_sure_a_given_temperature_is_stands_in_the_card(sysid, make_campaign, tmp_path):
    folder = make_campaign([(10.0, 2.0, 0.0), (10.0, 2.0, 0.5), (5.0, 2.0, 0.0)])
    told = {}
    for sd in ("", ", sd = 0", ", sd = 30"):
        text = f'[constants]\ntemperature = {{ value = 40, unit = "degC"{sd} }}\n'
        (folder / "campaign.toml").write_text(text, encoding="utf-8")
        said = sysid("fit", folder, "--model", "tanh", "-o", tmp_path / "out")
        card = read_card(tmp_path / "out" / "card.json")
        assert card.validity.temperature == (40.0, 40.0)
        words = [z for z in card.known_discrepancies if "standard deviation of" in z]
        assert words == [z for z in json.loads((tmp_path / "out" / "fit.json").read_text())["notes"]
                         if "standard deviation of" in z]  # fmt: skip
        assert all(f"Note: {z}" in said.err for z in words)
        told[sd] = words
    assert told[""] == told[", sd = 0"] == []
    (sentence,) = told[", sd = 30"]
    assert "of 3 of 3 tests was not recorded" in sentence
    assert "40 °C with a standard deviation of 30 K" in sentence


def test_intervals_by_all_rules_stand_in_fit_json_the_cards_among_them(fitted):
    card = read_card(fitted / "card.json")
    rules = json.loads((fitted / "fit.json").read_text())["intervals"]
    assert [rule["in_card"] for rule in rules] == [True, False, False, False]
    assert rules[0]["interval"] == card.interval
    own = rules[0]["parameters"]
    for p in card.parameters:
        if p.sd and p.symbol in own:
            assert (p.value, p.low, p.high) == tuple(
                own[p.symbol][z] for z in ("value", "low", "high")
            )
    assert "k_5" not in own  # held at zero
    plain = next(r for r in rules if "independent points" in r["interval"])["parameters"]
    for symbol in ("F_0", "a_1", "a_4", "k_4"):
        assert own[symbol]["sd"] > plain[symbol]["sd"]


def test_figures_are_pictures(fitted):
    for name in ("loops.png", "worst.png"):
        assert (fitted / name).read_bytes().startswith(b"\x89PNG")


def test_validate_repeats_the_errors_of_the_fit(fitted, sysid):
    said = sysid("validate", fitted / "card.json", LOW, "--json")
    assert said.code == 0
    fit = json.loads((fitted / "fit.json").read_text())
    expected = {t["id"]: t["nrmse"] for t in fit["tests"]}
    assert {t["id"]: t["nrmse"] for t in said.json["tests"]} == pytest.approx(expected, rel=1e-9)
    assert all(t["outside"] == [] for t in said.json["tests"])


def test_validate_outside_the_box_is_exit_3(fitted, sysid):
    said = sysid("validate", fitted / "card.json", DATASETS / "virtual-w11-high", "--json")
    assert said.code == 3
    assert len(said.json["tests"]) == 25
    assert all("amplitude" in t["outside"][0] for t in said.json["tests"])
    assert "outside the card's validity" in said.err


def test_validate_on_another_damper_is_exit_3(fitted, sysid, tmp_path):
    """The same motions with half the force."""
    other = tmp_path / "other"
    other.mkdir()
    for record in load_campaign(LOW).records[:6]:
        columns = np.column_stack([record.time, record.displacement, 0.5 * record.force])
        rows = (",".join(map(repr, row)) for row in columns.tolist())
        text = "\n".join(["time_s,displacement_m,force_N", *rows])
        (other / f"{record.id}.csv").write_text(text + "\n")
    said = sysid("validate", fitted / "card.json", other)
    assert said.code == 3
    assert "this is another damper, or it has changed" in said.err


def test_simulate_from_a_fitted_card(fitted, sysid, tmp_path):
    order = ["--amplitude", "12.5mm", "--frequency", "1.5Hz", "--current", "0.2A"]
    out = tmp_path / "force.csv"
    assert sysid("simulate", fitted / "card.json", *order, "-o", out).code == 0
    force = np.loadtxt(out, delimiter=",", skiprows=1)[:, 5]
    assert np.abs(force).max() == pytest.approx(980, rel=0.02)


@pytest.fixture(scope="module")
def few(tmp_path_factory) -> Path:
    """Six tests of the shipped campaign."""
    folder = tmp_path_factory.mktemp("few") / "campaign"
    some_tests(folder, [f"12.5mm_{f}Hz_{i}A" for f in ("0.5", "2.5") for i in ("0", "0.2", "0.4")])
    return folder


def goes_from_tests_to_a_force(model: str, campaign: Path, out: Path, sysid) -> float:
    """A card that reads back, errors that are found again, a force on a sine; the largest error."""
    said = sysid("fit", campaign, "-o", out, "--model", model, "--json")
    assert said.code == 0, said.err
    assert (said.json["model"], said.json["variant"]) == (model, VARIANTS[Model(model)][0])
    assert {p.name for p in out.iterdir()} == FILES
    errors = {t["id"]: t["nrmse"] for t in said.json["tests"]}
    checked = sysid("validate", out / "card.json", campaign, "--json")
    assert checked.code == 0, checked.err
    assert {t["id"]: t["nrmse"] for t in checked.json["tests"]} == pytest.approx(errors, rel=1e-9)
    sine = ["--amplitude", "12.5mm", "--frequency", "2.5Hz", "--current", "0.2A"]
    said = sysid("simulate", out / "card.json", *sine, "-o", out / "force.csv", "--json")
    assert said.code == 0, said.err
    motion = sine_motion(0.0125, 2.5, 0.2)
    force = np.asarray(simulate(damper_of(read_card(out / "card.json")), motion))
    assert said.json["force_max_N"] == pytest.approx(force.max(), rel=1e-9)
    return max(errors.values())


def test_a_rival_model_goes_from_tests_to_a_force(few, sysid, tmp_path):
    assert goes_from_tests_to_a_force("dahl", few, tmp_path / "out", sysid) < 0.25


@pytest.mark.parametrize(
    "model", sorted(set(Model) - {Model.dahl, Model.generalized, Model.lumped})
)
def test_every_model_has_its_card(model, few, sysid, tmp_path, monkeypatch):
    """As it stands before the search, whose compilation is long; the lumped one: test_fit_sweep."""

    def first_start(coordinates, problems, first, **options):
        return Minimum(first, 1.0, 1, (), Result.converged)

    monkeypatch.setattr("sysid.identification.fit.find_minimum", first_start)
    assert goes_from_tests_to_a_force(model, few, tmp_path / "out", sysid) < 0.5


def test_unknown_current_is_said(sysid, tmp_path):
    (tmp_path / "c").mkdir()
    for k, stem in enumerate(("12.5mm_1.5Hz_0A", "12.5mm_2.5Hz_0A")):
        lines = (LOW / f"{stem}.csv").read_text().splitlines()
        keep = [i for i, name in enumerate(lines[0].split(",")) if "current" not in name]
        rows = [",".join(line.split(",")[i] for i in keep) for line in lines]
        (tmp_path / "c" / f"test{k}.csv").write_text("\n".join(rows) + "\n")
    said = sysid("fit", tmp_path / "c", "-o", tmp_path / "out")
    assert said.code == 1
    assert "the current is not known" in said.err
    assert not (tmp_path / "out").exists()


def test_missing_campaign(sysid, tmp_path):
    said = sysid("fit", tmp_path / "nothing", "-o", tmp_path / "out")
    assert said.code == 1
    assert "nothing" in said.err
    shutil.rmtree(tmp_path / "out", ignore_errors=True)
    assert list(tmp_path.iterdir()) == []


def test_a_random_motion_is_fitted_on_its_own_grid(sysid, tmp_path):
    """Sums of sines of four frequencies, declared as random; the truth is known."""
    from sysid.models.generalized import LOW_SYMMETRIC, Generalized
    from sysid.motion.time_motion import time_motion
    from sysid.parameters import build

    folder, valve = tmp_path / "random", build(Generalized, LOW_SYMMETRIC)
    folder.mkdir()
    listing, rng, t = ["file,kind,current_A"], np.random.default_rng(0), np.arange(4000) / 500
    for current in (0.0, 0.1, 0.2, 0.4):
        phases = rng.uniform(0, 2 * np.pi, 4)
        frequencies = np.array((0.5, 0.875, 1.25, 2.125))[:, None]
        x = np.sum(0.003 * np.sin(2 * np.pi * frequencies * t + phases[:, None]), axis=0)
        force = np.asarray(simulate(valve, time_motion(t, x, current=current)))
        rows = np.column_stack([t, x, force + rng.normal(size=t.size)]).tolist()
        text = "\n".join(["time_s,displacement_m,force_N", *(",".join(map(repr, r)) for r in rows)])
        (folder / f"i{current}.csv").write_text(text + "\n")
        listing.append(f"i{current}.csv,random,{current}")
    (folder / "tests.csv").write_text("\n".join(listing) + "\n")
    out = tmp_path / "out"
    said = sysid("fit", folder, "-o", out, "--variant", "symmetric", "--holdout", "i0.1", "--json")
    assert said.code == 0, said.err
    assert {t["id"]: t["held_out"] for t in said.json["tests"]}["i0.1"]
    assert max(t["nrmse"] for t in said.json["tests"]) < 0.02
    card = read_card(out / "card.json")
    assert card.values()["F_0"] == pytest.approx(68.5, rel=0.03)
    assert card.validity.frequency is None
    assert card.validity.current == (0.0, 0.4)
    assert card.interval == "0.95, sandwich over tenths of 3 records"
    assert any("other motion was fitted" in line for line in card.known_discrepancies)
    assert said.json["intervals"][0]["interval"] == card.interval
    assert {p.name for p in out.iterdir()} == {
        "card.json", "fit.json", "report.html", "worst.png"
    }  # fmt: skip
    assert sysid("validate", out / "card.json", folder).code == 0


def test_files_say_that_a_fit_must_not_be_trusted(few, sysid, tmp_path, monkeypatch):
    """Whoever opens the card next has not seen the exit code."""
    monkeypatch.setattr("sysid.cli.identify.HOPELESS", 0.0)
    out = tmp_path / "out"
    said = sysid("fit", few, "-o", out, "--variant", "passive", "--json")
    assert said.code == 3
    assert said.json["trusted"] is False
    (reason,) = said.json["distrust"]
    assert reason in said.err
    card = read_card(out / "card.json")
    assert any("must not be trusted" in z and reason in z for z in card.known_discrepancies)


def test_results_of_an_earlier_run_are_told_and_left_alone(few, sysid, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    for name in ("bands-2.png", "diagnosis.json", "card.json", "notes.json", "my.png"):
        (out / name).write_text("before")
    said = sysid("fit", few, "-o", out, "--variant", "passive")
    assert said.code == 3, "at several currents, a model without"
    assert f"bands-2.png, diagnosis.json in {out} are of an earlier run" in said.err
    assert (out / "bands-2.png").read_text() == "before"
    assert (out / "card.json").read_text() != "before"
    again = sysid("fit", few, "-o", tmp_path / "new", "--variant", "passive")
    assert "earlier run" not in again.err
