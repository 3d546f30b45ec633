"""What the README tells of the physical datasets is what the benchmark left behind."""

import json
from pathlib import Path

import pytest

from sysid.rig.physical.mechanisms import MECHANISMS

ROOT = Path(__file__).resolve().parents[2]
TOLD = json.loads((ROOT / "benchmarks" / "results" / "physical_story.json").read_text())
SECTION = (ROOT / "README.md").read_text().split("## A damper whose truth is known")[1]
SECTION = " ".join(SECTION.split("\n## ")[0].split())


def percent(value: float) -> str:
    return f"{100 * value:.2g} %"


@pytest.mark.parametrize("quantity", ["noise_floor", "fit_error"])
def test_errors_stand_in_one_row(quantity):
    row = " | ".join(percent(TOLD[z][quantity]) for z in ("virtual-matrix-165", "virtual-sweep"))
    assert f"| {row} |" in SECTION


@pytest.mark.parametrize("dataset", ["virtual-matrix-165", "virtual-sweep"])
def test_the_largest_mechanisms_are_named_in_order(dataset):
    found = TOLD[dataset]["mechanisms"]
    assert {m["name"] for m in found} == {m.name for m in MECHANISMS}
    worth = [m["of_force"] for m in found]
    assert worth == sorted(worth, reverse=True)
    first = ", ".join(f"{m['name'].replace('_', ' ')} {percent(m['of_force'])}" for m in found[:4])
    assert f"| {first} |" in SECTION


def test_what_the_sweep_tells_besides():
    told = TOLD["virtual-sweep"]
    slope = told["static_N_per_K"]
    assert f"{slope['value']:.2f} ({slope['low']:.2f} … {slope['high']:.2f}) N more" in SECTION
    assert f"{percent(told['fit_error_no_static'])} are left" in SECTION
    assert told["bends"] == {"C_post": True, "F_y": False, "k": False}


STATUS = {
    "virtual-matrix-165": [("named", 0.90)] * 2 + [("class", 0.90)] * 4,
    "virtual-sweep": [("named", 0.90)] * 2 + [("class", 0.90)] * 2,
}


@pytest.mark.parametrize("dataset", STATUS)
def test_the_gain_and_every_cause_stand_there(dataset):
    told = TOLD[dataset]
    assert f"from {percent(told['base'])} to {percent(told['after'])}" in SECTION
    found = [(cause["status"], cause["confidence"]) for cause in told["names"]]
    assert found == [(status, pytest.approx(of)) for status, of in STATUS[dataset]]
    assert all(cause["is"] for cause in told["names"])


@pytest.mark.parametrize(
    ("dataset", "kind", "symbol", "scale", "words"),
    [
        ("virtual-matrix-165", "force_offset", "F_off", 1.0, "290 ± 2 N"),
        ("virtual-matrix-165", "bypass_leakage", "k_l", 1e6, "7.70 ± 0.19 mm/s"),
        ("virtual-matrix-165", "series_compliance", "s_k", 1e6, "0.208 ± 0.005 mm/kN"),
        ("virtual-matrix-165", "stribeck_friction", "F_s", 1.0, "92 ± 5 N"),
        ("virtual-matrix-165", "gas_spring", "k_g", 1e-3, "0.62 ± 0.11 kN/m"),
        ("virtual-sweep", "force_offset", "F_off", 1.0, "234.9 ± 1.5 N"),
        ("virtual-sweep", "gas_temperature", "c_gT", 1.0, "1.47 ± 0.07 N/K"),
        ("virtual-sweep", "gas_spring", "k_g", 1e-3, "2.4 ± 0.3 kN/m"),
        ("virtual-sweep", "force_filter", "tau_c", 1e3, "0.33 ± 0.05 ms"),
    ],
)
def test_every_size_is_the_one_that_was_told(dataset, kind, symbol, scale, words):
    cause = next(c for c in TOLD[dataset]["names"] if kind in c["said"])
    size = cause["parameters"][symbol]
    value, half = words.split(" ")[0:3:2]
    finest = 0.51 * resolution(half)
    assert words in SECTION
    assert scale * size["value"] == pytest.approx(float(value), abs=finest)
    assert scale * 0.5 * (size["high"] - size["low"]) == pytest.approx(float(half), abs=finest)


def resolution(number: str) -> float:
    """Of the last digit that says something: 10 for 50, 0.001 for 0.006."""
    whole, _, fraction = number.partition(".")
    return 10.0 ** (-len(fraction) if fraction else len(whole) - len(whole.rstrip("0")))
