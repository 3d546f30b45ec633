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


def test_the_gain_on_the_sweep_and_every_cause_stand_there():
    told = TOLD["virtual-sweep"]
    assert f"from {percent(told['base'])} to {percent(told['after'])}" in SECTION
    assert [(t["status"], f"{t['confidence']:.0%}") for t in told["names"]] == [
        ("named", "90%"), ("class", "90%"), ("class", "90%"), ("family", "65%"),
    ]  # fmt: skip
    assert all(t["is"] for t in told["names"])
