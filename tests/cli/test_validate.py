"""`sysid validate` of a card whose effects act on a campaign of known history."""

from pathlib import Path

import numpy as np
import pytest

from sysid.cards.models import damper_of
from sysid.cards.write import write_card
from sysid.effects.registry import effect_kind, make
from sysid.models.simulate import simulate
from sysid.motion.history import run_history, with_history
from sysid.motion.motion import sine_motion
from tests.cards.example import card_with

CYCLES = 8
FREQUENCIES = np.array([0.5, 1.5, 2.5])
ORDER = np.array([3.0, 1.0, 2.0])


@pytest.fixture(scope="module")
def aged(tmp_path_factory) -> tuple[Path, Path]:
    """A card with a gas spring and a drift of 20 %, and a campaign that it describes exactly."""
    root = tmp_path_factory.mktemp("aged")
    card = card_with(make(effect_kind("gas_spring")), make(effect_kind("run_drift"), 0.2))
    write_card(card, root / "card.json")
    motion = with_history(
        sine_motion(0.0125, FREQUENCIES, 0.2), run_history(ORDER, np.full(3, 0.2))
    )
    force = np.asarray(simulate(damper_of(card), motion))
    (root / "campaign").mkdir()
    listing = ["file,current_A,run_order"]
    for k, frequency in enumerate(FREQUENCIES):
        x, f = (np.tile(np.asarray(z)[k], CYCLES) for z in (motion.displacement, force))
        t = np.arange(x.size) / (360.0 * frequency)
        rows = (",".join(map(repr, row)) for row in np.column_stack([t, x, f]).tolist())
        text = "\n".join(["time_s,displacement_m,force_N", *rows])
        (root / "campaign" / f"t{k}.csv").write_text(text + "\n")
        listing.append(f"t{k}.csv,0.2,{ORDER[k]:g}")
    (root / "campaign" / "tests.csv").write_text("\n".join(listing) + "\n")
    return root / "card.json", root / "campaign"


def test_effects_and_the_order_of_the_tests_are_part_of_the_prediction(aged, sysid):
    card, campaign = aged
    said = sysid("validate", card, campaign, "--json")
    assert said.code == 0
    assert [t["nrmse"] < 1e-3 for t in said.json["tests"]] == [True, True, True]
    assert "has no say" not in said.err


def test_without_the_order_a_drift_is_told_to_be_absent(aged, sysid, tmp_path):
    """The last test has lost a fifth of its force, the first nothing."""
    card, campaign = aged
    for file in campaign.glob("t*.csv"):
        text = file.read_text()
        if file.stem == "tests":
            text = "\n".join(line.rsplit(",", 1)[0] for line in text.splitlines()) + "\n"
        (tmp_path / file.name).write_text(text)
    said = sysid("validate", card, tmp_path, "--json")
    assert "Note: run_drift has no say here: the motion does not tell" in said.err
    errors = {t["id"]: t["nrmse"] for t in said.json["tests"]}
    assert errors["t1"] < 1e-3
    assert errors["t0"] > 0.1
    assert 0.05 < errors["t2"] < errors["t0"]


@pytest.mark.parametrize(
    ("stated", "at_least", "code"), [(0.9, 0.05, 0), (0.003, 0.5, 0), (0.003, 0.05, 3)]
)
def test_the_error_is_told_in_parts_of_what_the_card_states(
    stated, at_least, code, aged, sysid, tmp_path, monkeypatch
):
    """The drift is taken from the card: a tenth of the force, in the mean."""
    monkeypatch.setattr("sysid.cli.validate.AT_LEAST", at_least)
    _, campaign = aged
    bare = card_with(make(effect_kind("gas_spring")))
    quality = bare.quality.model_copy(update={"mean_nrmse": stated})
    write_card(bare.model_copy(update={"quality": quality}), tmp_path / "card.json")
    said = sysid("validate", tmp_path / "card.json", campaign)
    assert said.code == code, said.err
    told = sysid("validate", tmp_path / "card.json", campaign, "--json").json
    ratio = told["summary"]["inside_mean_nrmse"] / stated
    assert told["summary"]["ratio"] == pytest.approx(ratio)
    assert f"inside its validity it is {ratio:.1f} times that" in said.out
    noted = [note for note in told["notes"] if "may be another damper" in note]
    assert len(noted) == (stated < 0.1 and code == 0)
    assert told["trusted"] == (code == 0)
