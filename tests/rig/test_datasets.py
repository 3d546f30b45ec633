"""The shipped virtual datasets: rebuilt byte for byte, and what they claim to be."""

import json
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import pytest

from sysid.models.generalized import ASYMMETRIC, HIGH_SYMMETRIC, LOW_SYMMETRIC, Generalized
from sysid.motion.motion import Motion
from sysid.parameters import build
from sysid.rig.campaign import make_campaign
from sysid.rig.scenarios import SCENARIOS, find_scenario
from sysid.rig.truth import open_seal

DATASETS = Path(__file__).parents[2] / "datasets"
DESIGNS = {
    "virtual-w11-low": (LOW_SYMMETRIC, [12.5], [0.5, 1.5, 2.5, 5.0], [0, 0.1, 0.2, 0.3, 0.4]),
    "virtual-w11-high": (HIGH_SYMMETRIC, [2.5], [5, 7.5, 10, 12.5, 15], [0, 0.1, 0.2, 0.3, 0.4]),
    "virtual-w11-asymmetric": (ASYMMETRIC, [12.5, 25], [0.5, 1.5], [0, 0.1, 0.2, 0.3]),
}
LONGEST = 3200
"""Samples, more than any file's steady part."""
SWEEPS = ("virtual-bs09", "virtual-bs09-frequency", "virtual-bs09-heating")
"""More of them in test_sweep_datasets.py."""
DRIVEN = ("virtual-asymmetric",)
"""More of it in test_asymmetric_campaign.py."""
every_dataset = pytest.mark.parametrize("name", DESIGNS)


def _table(path: Path) -> np.ndarray:
    """[n, 5] s, mm, N, A, °C."""
    return np.loadtxt(path, delimiter=",", skiprows=1)


def _data_files(name: str) -> list[Path]:
    return sorted(p for p in (DATASETS / name).glob("*.csv") if p.name != "tests.csv")


def test_every_scenario_is_shipped():
    assert {scenario.id for scenario in SCENARIOS} == {*DESIGNS, *SWEEPS, *DRIVEN}


@pytest.mark.parametrize("name", [*DESIGNS, *SWEEPS, *DRIVEN])
def test_rebuilds_byte_for_byte(name):
    made = make_campaign(find_scenario(name))
    folder = DATASETS / name
    shipped = {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()}
    assert shipped == set(made)
    different = [file for file, content in made.items() if (folder / file).read_bytes() != content]
    assert different == []


def test_another_seed_makes_other_measurements_of_the_same_damper(tmp_path):
    scenario = find_scenario("virtual-w11-low")
    own, other = make_campaign(scenario), make_campaign(scenario, seed=1)
    data = [file for file in own if file.endswith("A.csv")]
    assert set(own) == set(other)
    assert len(data) == 20
    assert all(own[file] != other[file] for file in data)
    (tmp_path / "truth.json").write_bytes(other["sealed/truth.json"])
    assert open_seal(tmp_path / "truth.json").parameters == LOW_SYMMETRIC


@every_dataset
def test_has_the_design_that_its_set_was_fitted_on(name):
    _, amplitudes, frequencies, currents = DESIGNS[name]
    design = {(a, f, i) for a in amplitudes for f in frequencies for i in currents}
    assert len(design) == {"low": 20, "high": 25, "asymmetric": 16}[name.split("-")[-1]]
    head, *rows = (DATASETS / name / "tests.csv").read_text().splitlines()
    assert head == "file,amplitude_mm,frequency_Hz,current_A,run_order,kind"
    cells = [row.split(",") for row in rows]
    assert {(float(a), float(f), float(i)) for _, a, f, i, _, _ in cells} == design
    assert sorted(int(order) for *_, order, _ in cells) == list(range(1, len(design) + 1))
    assert {file for file, *_ in cells} == {path.name for path in _data_files(name)}
    assert {kind for *_, kind in cells} == {"sine"}


def test_all_three_together_are_small():
    size = sum(p.stat().st_size for d in DESIGNS for p in (DATASETS / d).rglob("*") if p.is_file())
    assert size < 10e6


@every_dataset
def test_truth_is_the_published_table_and_stands_in_no_other_file(name):
    table = DESIGNS[name][0]
    truth = open_seal(DATASETS / name / "sealed" / "truth.json")
    assert truth.parameters == table
    assert set(truth.tests) == {path.stem for path in _data_files(name)}
    sealed = json.loads((DATASETS / name / "sealed" / "truth.json").read_text())
    assert sealed["sha256"] in (DATASETS / name / "README.md").read_text(encoding="utf-8")
    for file in ("README.md", "campaign.toml", "tests.csv", "sealed/truth.json"):
        text = (DATASETS / name / file).read_text(encoding="utf-8")
        assert str(table["F_0"]) not in text
        assert str(table["a_0"]) not in text


@every_dataset
def test_errors_between_tests_have_the_sizes_stated(name):
    tests = open_seal(DATASETS / name / "sealed" / "truth.json").tests.values()
    for key, size in (("gain", 0.006), ("offset", 2.0), ("delay", 1e-4)):
        rms = np.sqrt(np.mean([test[key] ** 2 for test in tests]))
        # 3.3 standard deviations of an RMS over n normal numbers
        assert abs(rms / size - 1.0) < 3.3 / np.sqrt(2 * len(tests))
    assert np.mean([test["centre"] for test in tests]) == pytest.approx(3.2e-3, abs=2e-4)
    assert np.mean([test["temperature"] for test in tests]) == pytest.approx(40.0, abs=1.5)


def _expected_force(table: dict[str, float], true: dict, time: np.ndarray) -> np.ndarray:
    """Force in steady cycles by the toolkit's model, from the seal's numbers alone, [n] N."""
    omega = 2 * np.pi * true["frequency"]
    # one length for all files, so that JAX compiles its operations once
    angle = omega * (np.pad(time, (0, LONGEST - time.size), mode="edge") - 0.15 - true["delay"])
    v = np.cos(angle)
    for order, size, lead in true["harmonics"]:
        v = v + order * size * np.cos(order * angle + 2 * np.pi * lead)
    motion = Motion(
        displacement=jnp.asarray(np.sin(angle)),
        velocity=jnp.asarray(true["amplitude"] * omega * v),
        acceleration=jnp.asarray(-np.sin(angle)),
        acceleration_sign=jnp.asarray(-np.sign(np.sin(angle))),
        peak_velocity=jnp.asarray([true["amplitude"] * omega]),
        current=jnp.asarray([true["current"]]),
        temperature=jnp.asarray([40.0]),
        time=jnp.asarray(angle / omega),
        frequency=jnp.asarray([true["frequency"]]),
        periodic=False,
    )
    force = np.asarray(build(Generalized, table).force(motion))[: time.size]
    return (1.0 + true["gain"]) * force + true["offset"]


@every_dataset
def test_each_file_is_the_model_with_the_sealed_errors_and_one_per_cent_of_noise(name):
    table = DESIGNS[name][0]
    truth = open_seal(DATASETS / name / "sealed" / "truth.json")
    for path in _data_files(name):
        true, data = truth.tests[path.stem], _table(path)
        turns = (data[:, 0] - 0.15) * true["frequency"]
        steady = data[(turns > 1.55) & (turns < 9.45)]
        expected = _expected_force(table, true, steady[:, 0])
        noise = steady[:, 2] - expected
        n, rms = noise.size, np.sqrt(np.mean(expected**2))
        assert np.std(noise) / rms == pytest.approx(0.01, rel=4 / np.sqrt(2 * n) + 0.01), path.stem
        assert abs(np.mean(noise)) < 4 * np.std(noise) / np.sqrt(n), path.stem
        assert np.max(np.abs(noise)) < 6 * 0.0101 * rms, path.stem
        assert np.mean(steady[:, 3]) == pytest.approx(true["current"], abs=1e-4)
        assert 34.0 < np.mean(steady[:, 4]) < 46.0


@every_dataset
def test_files_are_raw(name):
    """Rest, ramp, at least six steady cycles, ramp, rest; uniform sampling; centre not at zero."""
    for path in _data_files(name):
        t, x, force = _table(path)[:, :3].T
        step = np.diff(t)
        np.testing.assert_allclose(step, step[0], rtol=1e-6)
        assert 200 <= round(1 / step[0]) <= 2000
        for rest in (t < 0.14, t > t[-1] - 0.14):
            assert np.ptp(x[rest]) < 0.04
            assert np.mean(x[rest]) == pytest.approx(3.2, abs=0.8)
            assert np.std(force[rest]) < 0.02 * np.max(np.abs(force))
        swing = x - np.mean(x[t < 0.14])
        top = np.max(swing)
        inside = swing[1:-1]
        peaks = (inside > swing[:-2]) & (inside >= swing[2:]) & (inside > 0.5 * top)
        whole = t[1:-1][peaks & (inside > 0.985 * top)]
        period = 1 / float(path.stem.split("_")[1].removesuffix("Hz"))
        assert np.ptp(whole) > 6.9 * period
        assert np.count_nonzero(inside > 0.02 * top) < inside.size
