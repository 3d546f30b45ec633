"""`sysid fit` with a posterior, cut short: what it writes and what it says."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sysid.cards import read_card
from sysid.cli.drawing import Draws, told_of_draws
from sysid.cli.left_behind import left_behind
from sysid.uncertainty.posterior_file import read_posterior
from sysid.uncertainty.side_by_side import MOST
from tests.structure.result_keys import missing, written

LOW = Path(__file__).parents[2] / "datasets" / "virtual-w11-low"


def test_a_posterior_that_had_no_time_is_written_and_called_not_converged(sysid, tmp_path):
    out = tmp_path / "out"
    said = sysid(
        "fit", LOW, "-o", out, "--variant", "symmetric", "--posterior-budget", "1s",
        "--holdout", "12.5mm_2.5Hz_*",
    )  # fmt: skip
    assert said.code == 0, said.err
    assert "ends after 1 s" in said.err
    assert "has not converged (the time budget was spent)" in said.err
    assert "F_0 [N]: log-normal, median 70, a factor of 10 either way" in said.out
    assert {p.name for p in out.iterdir()} == {
        "card.json", "fit.json", "loops.png", "report.html", "worst.png",
        "posterior.h5", "corner.png", "trace.png", "profiles.png", "bands.png",
    }  # fmt: skip
    assert set(left_behind(out, ())) == {p.name for p in out.iterdir()}, "a later run knows all"
    card = read_card(out / "card.json")
    told = card.posterior
    assert told is not None
    assert (told.file, told.likelihood, told.ensembles) == ("posterior.h5", "full", 4)
    assert not told.converged
    assert "the time budget was spent" in told.message
    assert [p.symbol for p in told.parameters] == list(card.covariance.symbols)
    fit = json.loads((out / "fit.json").read_text())
    assert missing(written(fit), "fit.json") == []
    determined = fit["identifiability"]
    assert set(determined["profiles"]) == set(card.covariance.symbols)
    profile = determined["profiles"]["F_0"]
    assert profile["closed"] == [True, True]
    assert profile["low"] < card.values()["F_0"] < profile["high"]
    assert "The height of the loop at standstill is known to" in said.out
    bands_are_told(fit["bands"], said.out)
    posterior = read_posterior(out / "posterior.h5")
    for one, column in zip(told.parameters, posterior.flat.T, strict=True):
        assert one.low <= one.median <= one.high
        assert one.median == pytest.approx(np.median(column), abs=0.5 * one.sd)
    values = card.values()
    near = {p.symbol: p for p in told.parameters}
    assert abs(near["F_0"].median - values["F_0"]) < 3.0


def bands_are_told(bands: dict, said: str) -> None:
    """Of all tests, those held out included, and in sentences."""
    assert all(sentence in said.replace("\n", " ") for sentence in bands["sentences"])
    assert "3 conditions (amplitude, frequency) are too few for a conformal band" in said
    assert bands["conformal"]["score"] is None
    assert bands["conformal"]["conditions_needed"] == 19
    held = [t for t in bands["tests"] if t["held_out"]]
    assert {t["id"] for t in held} == {
        f"12.5mm_2.5Hz_{i}A" for i in ("0", "0.1", "0.2", "0.3", "0.4")
    }
    for test in bands["tests"]:
        assert test["inside_recorded"] > 0.8
        assert test["extrapolated_in"] is None
        widths = test["mean_half_width_N"]
        assert set(widths) == {"parameters", "laws", "recorded"}
        assert widths["laws"] < widths["recorded"]
        energy = test["dissipated_energy_J"]
        assert 0.0 < energy["low"] < energy["value"] < energy["high"] < 1.1 * energy["value"]
        assert test["standstill_half_height_N"]["value"] < test["peak_force_N"]["value"]


@pytest.mark.parametrize("time", ["0s", "soon", "5 parsecs", "-1"])
def test_a_budget_that_is_no_time_is_wrong_usage(sysid, tmp_path, time):
    said = sysid("fit", LOW, "-o", tmp_path / "out", "--posterior-budget", time)
    assert said.code == 2
    assert not (tmp_path / "out").exists()


def test_of_more_tests_than_a_covariance_is_sought_of_nothing_is_drawn_and_that_is_said(
    sysid, tmp_path, monkeypatch
):
    monkeypatch.setattr("sysid.uncertainty.side_by_side.MOST", 3)
    monkeypatch.setattr("sysid.uncertainty.sample.errors_of", None)
    out = tmp_path / "out"
    said = sysid("fit", LOW, "-o", out, "--variant", "passive", "--posterior")
    assert said.code == 3, said.err  # tests at other currents, for the sake of a quick fit
    told = "No posterior is drawn: the covariance of errors of rig and laws is sought of at most 3"
    assert told in said.err.replace("\n", " ")
    assert not (out / "posterior.h5").exists()
    card = read_card(out / "card.json")
    assert card.posterior is None
    assert any(z.startswith(told) for z in card.known_discrepancies)


def some(loops: int, others: int) -> tuple[Any, Any]:
    """A fit of so many tests, and its selection, as far as they are asked of here."""
    made = np.array([f"{k}" for k in range(loops)])
    tests = [SimpleNamespace(id=f"{k}", used=True) for k in range(loops + others)]

    def select(chosen: np.ndarray) -> SimpleNamespace:
        return SimpleNamespace(ids=tuple(made[chosen]))

    chosen = SimpleNamespace(loops=SimpleNamespace(ids=tuple(made), select=select))
    return SimpleNamespace(tests=tests), chosen


@pytest.mark.parametrize(
    ("loops", "others", "likelihood", "said"),
    [
        (20, 0, "full", None),
        (MOST, 0, "full", None),
        (MOST + 1, 0, "full", f"at most {MOST} tests, and {MOST + 1} were fitted"),
        (MOST + 1, 0, "random_effects", None),
        (0, 2, "full", "one of steady sines, and none was fitted"),
        (20, 2, "full", "of the 20 steady sines alone: the other 2 of 22 fitted tests"),
    ],
)
def test_what_a_posterior_cannot_know_is_said(loops, others, likelihood, said):
    told = told_of_draws(Draws(likelihood, 1.0), *some(loops, others))
    assert len(told) == (said is not None)
    assert said is None or said in told[0]
    assert told_of_draws(None, *some(loops, others)) == ()
