"""`sysid fit` on what a bench leaves of a campaign: a test, a pair, one current, one frequency."""

import json
import shutil

import pytest

from tests.cli.shipped import LOW

NOISE = 0.006
"""Of the peak force, what a fit of the shipped tests leaves."""
ONE = ("12.5mm_1.5Hz_0.2A.csv",)
OF_CURRENT = {"I_0", "I_1", "a_2", "a_3", "k_2", "k_3"}


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
    campaign = tmp_path / "campaign"
    campaign.mkdir()
    for glob in ("campaign.toml", *globs):
        for file in LOW.glob(glob):
            shutil.copy(file, campaign)
    out = tmp_path / "out"
    said = sysid("fit", campaign, "-o", out, "--variant", "symmetric", "--quiet")
    assert said.code in (0, 3), said.err  # 3: fitted, with a reason not to trust all of it
    fit = json.loads((out / "fit.json").read_text())
    assert fit["summary"]["mean_nrmse"] < NOISE
    card = json.loads((out / "card.json").read_text())
    identified = {p["symbol"] for p in card["parameters"] if p["identified"]}
    assert not open_ones & identified
    assert {"F_0", "a_4", "k_1c"} & identified or globs == ONE
