"""`sysid fit` on what a bench leaves of a campaign: a test, a pair, one current, one frequency."""

import json
import shutil
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.cli.shipped import LOW

NOISE = 0.006
"""Of the peak force, what a fit of the shipped tests leaves."""
ONE = ("12.5mm_1.5Hz_0.2A.csv",)
OF_CURRENT = {"I_0", "I_1", "a_2", "a_3", "k_2", "k_3"}


def _copied(globs: Sequence[str], folder: Path) -> Path:
    """The tests of a shipped campaign that some patterns name."""
    campaign = folder / "campaign"
    campaign.mkdir()
    for glob in ("campaign.toml", *globs):
        for file in LOW.glob(glob):
            shutil.copy(file, campaign)
    return campaign


def test_a_fit_that_failed_has_its_report_all_the_same(tmp_path, sysid):
    """It leaves F_0 at 1e-306, where the slope of the force overflows."""
    globs = [f"12.5mm_{f}Hz_{i}A.csv" for f in (0.5, 1.5, 2.5) for i in (0, 0.2)]
    order = ("--variant", "passive", "--frequency-range", "2 6", "--no-posterior")
    said = sysid("fit", _copied(globs, tmp_path), *order, "-o", tmp_path / "out")
    assert said.code == 3
    assert "does not describe this damper" in said.err
    fitted = json.loads((tmp_path / "out" / "fit.json").read_text())
    assert not fitted["trusted"]


@pytest.mark.parametrize(
    ("globs", "open_ones"),
    [
        (ONE, OF_CURRENT),
        (("12.5mm_1.5Hz_0.2A.csv", "12.5mm_5Hz_0A.csv"), {"a_2", "a_3"}),
        (("*_0.2A.csv",), OF_CURRENT),
        (("*_0A.csv",), OF_CURRENT),
        (("*_0A.csv", "*_0.2A.csv"), {"a_2", "a_3"}),
        (("*_1.5Hz_*.csv",), {"a_0", "k_0"}),
    ],
    ids=["one", "two", "one current", "off", "two currents", "one frequency"],
)
def test_loops_are_met_and_what_nothing_tells_is_open(globs, open_ones, tmp_path, sysid):
    """The model meets all loops, what was not varied leaves laws open, and some are known."""
    campaign = _copied(globs, tmp_path)
    out = tmp_path / "out"
    said = sysid("fit", campaign, "-o", out, "--variant", "symmetric")
    assert said.code in (0, 3), said.err  # 3: fitted, with a reason not to trust all of it
    fit = json.loads((out / "fit.json").read_text())
    alone = open_ones == OF_CURRENT
    assert ("--variant passive" in said.out + said.err) == alone
    assert any("--variant passive" in note for note in fit["notes"]) == alone
    assert fit["summary"]["mean_nrmse"] < NOISE
    card = json.loads((out / "card.json").read_text())
    identified = {p["symbol"] for p in card["parameters"] if p["identified"]}
    assert not open_ones & identified
    assert {"F_0", "a_4", "k_1c", "k_4"} & identified or globs == ONE


def test_what_one_current_tells_is_fitted_by_the_variant_that_is_advised(tmp_path, sysid):
    campaign = _copied(("*_0.2A.csv",), tmp_path)
    out = tmp_path / "out"
    said = sysid("fit", campaign, "-o", out, "--variant", "passive")
    assert said.code == 0
    assert "All fitted tests have one current" not in said.out + said.err
    card = json.loads((out / "card.json").read_text())
    assert all(p["identified"] for p in card["parameters"] if p["symbol"] in {"F_0", "k_0", "a_0"})
