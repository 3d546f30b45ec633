"""`sysid next` as a user runs it, on what a diagnosis left behind."""

import json
from dataclasses import replace

import numpy as np
import pytest

from sysid.cards.open_questions import FILE, open_file, open_text, read_open
from sysid.data.manifest import Amount, LimitsSection, Manifest
from sysid.diagnosis.questions import Open, Told
from sysid.planning.candidates import Candidate
from sysid.planning.discrimination import predict
from tests.planning.asked import NOISE, SIZES, a_class
from tests.report.made_diagnosis import backlash

LIMITS = LimitsSection(
    stroke=Amount(value=150.0, unit="mm"), velocity=Amount(value=0.5, unit="m/s"),
    current=Amount(value=0.4, unit="A"),
)  # fmt: skip


@pytest.fixture
def folder(tmp_path):
    """Of a diagnosis that left a class open."""
    mass = -1000.0 / (3 * np.pi) ** 2
    asked = a_class("gas_spring", "fluid_inertia", gas_spring=1000.0, fluid_inertia=mass)
    asked = replace(asked, told=(Told(("load_cell_gain",), "Calibrate with a dead weight"),))
    text = open_text(open_file(asked, backlash(), Manifest(limits=LIMITS)))
    (tmp_path / FILE).write_text(text)
    return tmp_path


def test_tests_with_reasons(folder, sysid):
    said = sysid("next", folder)
    assert said.code == 0, said.err
    assert said.out.startswith("1. ")
    assert "tells a gas spring from inertia of the fluid (beyond doubt)" in said.out
    assert "Assumed: frequencies of at most 20 Hz." in said.err
    assert "Assumed: frequencies from 0.1 Hz and amplitudes from 0.25 mm on." in said.err
    assert "[limits] in the manifest" in said.err
    told = "Not simulated here: a gain error of the load cell. Calibrate with a dead weight."
    assert told in said.out


def test_json_alone_on_stdout(folder, sysid):
    said = sysid("next", folder, "--json")
    found = json.loads(said.out)
    assert found["schema"] == "sysid-next-1"
    (test,) = found["tests"]
    assert test["about"] == ["gas_spring", "fluid_inertia"]
    assert test["amplitude_m"] <= 0.075
    assert 2 * np.pi * test["amplitude_m"] * test["frequency_Hz"] <= 0.5
    assert found["settled"] == [["gas_spring", "fluid_inertia"]]
    assert {e["ids"][0] for e in test["expected"]} == {"gas_spring", "fluid_inertia"}


def test_that_no_limit_of_the_force_is_known_is_told(folder, sysid):
    """With what was measured and what the tests ask for at most."""
    measured = np.abs(backlash().loops.force).max()
    said = sysid("next", folder)
    none = f"no limit of the force, as none is known (the largest measured is {measured:.4g} N)"
    assert f"Assumed: {none}." in said.err
    found = json.loads(sysid("next", folder, "--json").out)
    assert none in found["assumed"]
    (test,) = found["tests"]
    largest = test["largest_force_N"]
    assert f"The largest force to expect in these tests is {largest:.4g} N" in said.err
    case = read_open(folder)
    (question,) = case.asked.questions
    asked = Candidate(
        test["kind"], *(test[k] for k in ("amplitude_m", "frequency_Hz", "current_A"))
    )
    expected = [predict(one, [asked], 40.0).force for one in question.alternatives]
    assert largest == pytest.approx(np.abs(expected).max())
    assert largest >= max(abs(e["force_N"]) for e in test["expected"])


def test_a_limit_of_the_force_is_no_assumption(folder, sysid):
    manifest = Manifest(limits=LIMITS.model_copy(update={"force": Amount(value=2.0, unit="kN")}))
    asked = read_open(folder).asked
    (folder / FILE).write_text(open_text(open_file(asked, backlash(), manifest)))
    said = sysid("next", folder)
    assert said.code == 0, said.err
    assert said.out.startswith("1. ")
    assert "orce" not in said.err


def test_an_older_file_does_not_tell_the_largest_force(folder, sysid):
    file = json.loads((folder / FILE).read_text())
    del file["conditions"]["force_N"]
    (folder / FILE).write_text(json.dumps(file))
    said = sysid("next", folder)
    assert said.code == 0, said.err
    assert "Assumed: no limit of the force, as none is known." in said.err


def test_what_is_read_is_what_was_written(folder):
    case = read_open(folder)
    mass = -1000.0 / (3 * np.pi) ** 2
    asked = a_class("gas_spring", "fluid_inertia", gas_spring=1000.0, fluid_inertia=mass)
    (question,), (first,) = case.asked.questions, asked.questions
    assert question.about == first.about
    assert case.asked.sizes == SIZES
    assert case.asked.noise == NOISE
    assert case.limits.amplitude[1] == pytest.approx(0.075)
    for one, other in zip(question.alternatives, first.alternatives, strict=True):
        assert one.symbols == other.symbols
        np.testing.assert_array_equal(one.covariance, other.covariance)
        assert one.damper == other.damper


@pytest.mark.parametrize(
    ("answer", "told"),
    [
        ("named", "left no explanations that a simulated test could tell apart"),
        ("unknown", "ended with 'unknown': it has no rival explanations"),
        ("base_inadequate", "ended with 'base inadequate': it has no rival explanations"),
    ],
)
def test_where_nothing_can_be_told_apart_it_says_why(tmp_path, sysid, answer, told):
    found = replace(backlash(), answer=answer)
    none = Open((), (Told(("coil_lag",), "Step the current"),), SIZES, NOISE)
    (tmp_path / FILE).write_text(open_text(open_file(none, found, Manifest())))
    said = sysid("next", tmp_path)
    assert said.code == 0
    assert told in said.out
    assert "Not simulated here: lag of the coil current. Step the current." in said.out


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (lambda f: f.unlink(), "no folder of a diagnosis"),
        (lambda f: f.write_text("{"), "Invalid JSON"),
        (lambda f: f.write_text(f.read_text().replace('"gas_spring"', '"gas_spoon"')), "gas_spoon"),
        (lambda f: f.write_text(f.read_text().replace('"F_0"', '"F_9"')), "F_"),
        (lambda f: f.write_text(f.read_text().replace("sysid-open-1", "sysid-open-9")), "schema"),
        (lambda f: f.write_text(f.read_text().replace('"noise_N": ', '"noise_N": -')), "noise_N"),
    ],
)
def test_a_spoilt_file_is_refused_with_advice(folder, sysid, spoil, told):
    spoil(folder / FILE)
    said = sysid("next", folder)
    assert said.code == 1
    assert told in said.err
    assert "sysid diagnose" in said.err
