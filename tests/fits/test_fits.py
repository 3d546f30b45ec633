"""The committed fits are what the program makes of the shipped datasets."""

import json
from pathlib import Path

import pytest

from sysid.cli.app import run

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize(
    ("dataset", "variant"),
    [
        ("virtual-w11-low", "symmetric"),
        ("virtual-w11-high", "symmetric"),
        ("virtual-w11-asymmetric", "asymmetric"),
    ],
)
def test_fit_is_rebuilt(dataset, variant, tmp_path):
    out = tmp_path / "out"
    arguments = ["fit", str(ROOT / "datasets" / dataset), "--variant", variant, "-o", str(out)]
    assert run([*arguments, "--no-posterior", "--quiet"]) == 0
    new, old = (json.loads((d / "fit.json").read_text()) for d in (out, ROOT / "fits" / dataset))
    assert new["summary"]["cost"] == pytest.approx(old["summary"]["cost"], rel=1e-6)
    assert [t["id"] for t in new["tests"]] == [t["id"] for t in old["tests"]]
    for a, b in zip(new["tests"], old["tests"], strict=True):
        assert a["rmse_N"] == pytest.approx(b["rmse_N"], rel=1e-3)
    new, old = (json.loads((d / "card.json").read_text()) for d in (out, ROOT / "fits" / dataset))
    assert new.keys() == old.keys()
    assert new["data"] == old["data"]
    assert new["validity"].keys() == old["validity"].keys()
    for name, ends in old["validity"].items():  # sums are rounded as the processor takes them
        assert new["validity"][name] == (
            pytest.approx(ends, rel=1e-12) if isinstance(ends, list | float) else ends
        ), name
    for a, b in zip(new["parameters"], old["parameters"], strict=True):
        assert a["symbol"] == b["symbol"]
        assert a["identified"] == b["identified"], a["symbol"]
        if b["identified"]:
            assert a["value"] == pytest.approx(b["value"], abs=max(0.02 * b["sd"], 1e-9))


@pytest.mark.parametrize("dataset", ["virtual-w11-low", "virtual-w11-high"])
def test_committed_card_predicts_its_own_tests(dataset, capsys):
    card = ROOT / "fits" / dataset / "card.json"
    assert run(["validate", str(card), str(ROOT / "datasets" / dataset), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    stored = json.loads((ROOT / "fits" / dataset / "fit.json").read_text())
    for a, b in zip(found["tests"], stored["tests"], strict=True):
        assert a["rmse_N"] == pytest.approx(b["rmse_N"], rel=1e-6)
