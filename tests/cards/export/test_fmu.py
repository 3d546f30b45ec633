"""The FMU by FMPy: valid, and the same forces as `sysid simulate --causal`."""

import zipfile
from io import BytesIO
from xml.etree import ElementTree

import numpy as np
import pytest

from sysid.cards.export import compiler
from sysid.cards.export.fmu import description, fmu_of
from sysid.cards.export.pieces import pieces_of
from tests.cards.example import example_card
from tests.cards.export.dampers import damper
from tests.cards.export.program import needs_compiler, random_rows
from tests.cards.export.test_c import simulated

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed (extra dev)")


@pytest.fixture(scope="module")
def fmu(tmp_path_factory):
    made = fmu_of(example_card(), pieces_of(damper("laws"), "generalized"), "unit")
    path = tmp_path_factory.mktemp("fmu") / "unit.fmu"
    path.write_bytes(made.data)
    return path


@needs_compiler
def test_it_passes_the_validation(fmu):
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(fmu)) == []


@needs_compiler
def test_forces_state_and_parameters(fmu, tmp_path):
    from fmpy.fmi2 import FMU2Slave

    told = fmpy.read_model_description(str(fmu))
    number = {v.name: v.valueReference for v in told.modelVariables}
    slave = FMU2Slave(
        guid=told.guid, unzipDirectory=fmpy.extract(str(fmu), str(tmp_path / "unit")),
        modelIdentifier="unit", instanceName="one",
    )  # fmt: skip
    slave.instantiate()
    rows = random_rows(700)
    inputs = [number[z] for z in ("displacement", "velocity", "current", "temperature")]

    def step(k: int) -> float:
        slave.setReal(inputs, rows[k, [1, 2, 4, 5]].tolist())
        if k == 0:
            slave.setupExperiment(startTime=rows[0, 0])
            slave.enterInitializationMode()
            slave.exitInitializationMode()
        else:
            slave.doStep(rows[k - 1, 0], rows[k, 0] - rows[k - 1, 0])
        return slave.getReal([number["force"]])[0]

    expected = simulated(damper("laws"), rows)
    force = np.array([step(k) for k in range(600)])
    assert np.abs(force - expected[:600]).max() <= 1e-8 * np.abs(expected).max()

    state = slave.getFMUState()
    first = [step(k) for k in range(600, 700)]
    slave.setFMUState(state)
    assert [step(k) for k in range(600, 700)] == first

    assert slave.getReal([number["F_0"]]) == [79.92]
    slave.setReal([number["F_0"]], [159.84])
    slave.setFMUState(state)
    assert slave.getReal([number["F_0"]]) == [79.92]
    slave.setReal([number["F_0"]], [159.84])
    assert step(600) != first[0]

    slave.setReal([number["displacement"]], [np.nan])
    held = slave.getReal([number["force"]])
    slave.doStep(rows[600, 0], 1e-3)
    assert slave.getReal([number["force"]]) == held
    slave.freeFMUState(state)
    slave.terminate()
    slave.freeInstance()


@needs_compiler
def test_the_same_card_gives_the_same_bytes(fmu):
    made = fmu_of(example_card(), pieces_of(damper("laws"), "generalized"), "unit")
    assert made.data == fmu.read_bytes()


@pytest.mark.parametrize(
    ("frequency", "stop"), [((0.0, 5.0), "0.4"), ((0.5, 5.0), "4"), (None, "2")]
)
def test_any_card_has_a_description_that_can_be_read(frequency, stop):
    made = example_card()
    validity = made.validity.model_copy(update={"frequency": frequency})
    name = made.damper.model_copy(update={"name": "MR\x00\x1b[1m-\ud8001 <阻尼器>\ufffe"})
    made = made.model_copy(update={"validity": validity, "damper": name})
    text = description(made, pieces_of(damper("carreau"), "carreau"), "unit", "{0}")
    root = ElementTree.fromstring(text.encode())
    assert root.attrib["modelName"] == "MR[1m-1 <阻尼器>"
    (experiment,) = root.iter("DefaultExperiment")
    assert experiment.attrib["stopTime"] == stop


def test_without_a_compiler_it_has_its_source_only(monkeypatch):
    monkeypatch.setattr(compiler, "compiler", lambda: None)
    made = fmu_of(example_card(), pieces_of(damper("carreau"), "carreau"), "unit")
    assert made.platform is None
    assert "no C compiler" in (made.why or "")
    names = zipfile.ZipFile(BytesIO(made.data)).namelist()
    assert names == ["modelDescription.xml", "sources/unit.c", "sources/unit.h"]
