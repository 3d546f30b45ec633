"""What an exported program tells of samples that its card was not identified at."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from sysid.cards.export import compiler
from sysid.cards.export.box import unknown_temperature
from sysid.cards.export.c_program import c_program
from sysid.cards.export.fmu import description, fmu_of
from sysid.cards.export.modelica import modelica_package
from sysid.cards.export.pieces import pieces_of
from sysid.cards.export.tables import table_csv, table_of
from sysid.cards.models import damper_of
from sysid.cards.motion_box import motion_outside
from sysid.cards.schema import Card
from sysid.models.damper import Damper
from sysid.motion.time_motion import time_motion
from tests.cards.example import example_card
from tests.cards.export.dampers import damper, valve
from tests.cards.export.program import NAME, Program, needs_compiler

INSIDE = [0.0, 0.002, 0.1, 0.0, 0.2, 40.0]
"""Time, displacement, velocity, acceleration, current, temperature."""
SAMPLES = [
    (1, 0.01275, 0), (1, 0.0128, 1), (1, -0.0128, 1), (2, 0.4008, 0), (2, 0.401, 2), (2, -5.0, 2),
    (4, -0.008, 0), (4, 0.408, 0), (4, 0.409, 4), (4, -0.009, 4), (4, 2.0, 4),
    (5, 52.0, 0), (5, 52.1, 8), (5, 27.9, 8), (5, 200.0, 8),
]  # fmt: skip
"""Column of a sample, its value, and what it is outside of: 12.5 mm, 0.393 m/s, 0.4 A, 30–50 °C."""
PLAIN = Damper(valve("generalized"), ())


def boxed(**changed: object) -> Card:
    card = example_card()
    return card.model_copy(update={"validity": card.validity.model_copy(update=changed)})


def sample(column: int, value: float) -> list[float]:
    row = list(INSIDE)
    row[column] = value
    return row


def simulate_warns(row: list[float]) -> bool:
    """As `sysid simulate` on a motion that has this instant, beside one that is inside."""
    _, x, v, a, i, warm = np.array([INSIDE] * 8 + [row]).T
    t = 1e-3 * np.arange(9)
    motion = time_motion(t, x, velocity=v, acceleration=a, current=i, temperature=warm)
    return bool(motion_outside(example_card().validity, motion))


@pytest.fixture(scope="module")
def plain(tmp_path_factory) -> Program:
    return Program("generalized", PLAIN, tmp_path_factory.mktemp("plain"))


@needs_compiler
@pytest.mark.parametrize(("column", "value", "bit"), SAMPLES)
def test_a_step_tells_what_simulate_warns_of(column, value, bit, plain):
    row = sample(column, value)
    plain.reset()
    assert plain.step(row)[1] == (4 if bit else 0)
    assert plain.outside() == bit
    assert simulate_warns(row) is bool(bit)


@needs_compiler
def test_the_force_outside_is_that_of_a_card_that_knows_no_bounds(plain, tmp_path):
    wide = boxed(amplitude=(1e-3, 9.0), velocity=(0.0, 99.0), current=(-9.0, 9.0), temperature=None)
    free = Program("generalized", PLAIN, tmp_path, wide)
    rows = [sample(c, value) for c, value, _ in SAMPLES]
    rows = [[0.01 * k, *row[1:]] for k, row in enumerate(rows)]
    plain.reset()
    told = [plain.step(row) for row in rows]
    assert [force for force, _ in told] == [free.step(row)[0] for row in rows]
    assert {code for _, code in told} == {0, 4}
    assert free.outside() == 0
    assert plain.step([1.0, 0.1, 5.0, 0.0, 2.0, 200.0])[1] == 4
    assert plain.outside() == 1 + 2 + 4 + 8
    assert plain.step([1.1, *INSIDE[1:]])[1] == 0
    assert plain.outside() == 0


@needs_compiler
def test_other_codes_win_and_what_is_refused_leaves_it(plain):
    plain.reset()
    far = [0.0, 0.1, 0.1, 0.0, 0.2, 40.0]
    assert plain.step(far)[1] == 4
    assert plain.step(far)[1] == 1, "time does not increase"
    assert plain.outside() == 1
    plain.reset()
    assert plain.outside() == 0
    light = [0.0, 0.02, 0.0, np.nan, 0.1, 40.0]
    assert plain.in_plant(light, 2.0, -2000.0)[2] == 2, "the peak speed runs away"
    assert plain.outside() == 1
    plain.reset()
    assert plain.in_plant([0.0, 0.02, 0.03, np.nan, 0.2, 40.0], 20.0, 100.0)[2] == 4
    plain.reset()
    assert plain.in_plant([0.0, 0.002, 0.03, np.nan, 0.2, 40.0], 20.0, 100.0)[2] == 0


@needs_compiler
def test_a_speed_that_is_estimated_counts_as_well(plain):
    plain.reset()
    codes = [plain.step([0.01 * k, x, np.nan, np.nan, 0.2, 40.0])[1] for k, x in
             enumerate((0.0, 0.003, 0.008))]  # fmt: skip
    assert codes == [0, 0, 4]
    assert plain.outside() == 2


@needs_compiler
@pytest.mark.parametrize(
    ("case", "temperature", "bit"),
    [("laws", (10.0, 20.0), 8), ("laws", (30.0, 50.0), 0), ("laws", None, 0),
     ("carreau", (10.0, 20.0), 0)],
)  # fmt: skip
def test_an_unknown_temperature_is_the_one_that_is_computed_with(case, temperature, bit, tmp_path):
    """40 °C where the force goes by it, as in `sysid simulate`; nothing elsewhere."""
    model = {"laws": "generalized", "carreau": "carreau"}[case]
    program = Program(model, damper(case), tmp_path, boxed(temperature=temperature))
    program.step(sample(5, np.nan))
    assert program.outside() == bit


def test_what_stands_for_an_unknown_temperature_is_no_departure_where_it_has_no_say():
    thermal, cold = pieces_of(damper("laws"), "generalized"), boxed(temperature=(10.0, 20.0))
    indifferent = pieces_of(PLAIN, "generalized")
    assert unknown_temperature(cold, thermal) == 40.0
    assert unknown_temperature(cold, indifferent) == 20.0
    assert unknown_temperature(example_card(), indifferent) == 40.0
    assert unknown_temperature(boxed(temperature=None), indifferent) == 40.0
    text = description(cold, indifferent, "unit", "{0}")
    assert '<Real start="20" unit="degC"/>' in text
    assert "20 where it is not known" in text
    assert "damper.temperature = 20;" in modelica_package(cold, indifferent, NAME)["Unit.mo"]


def test_a_header_tells_all_conditions_and_what_no_sample_tells():
    head = " ".join(c_program(example_card(), pieces_of(PLAIN, "generalized"), NAME)["unit.h"]
                    .replace("\n *", " ").split())  # fmt: skip
    assert "amplitudes 12.5 to 12.5 mm, frequencies 0.5 to 5 Hz, speeds up to 0.393 m/s" in head
    assert "One sample does not tell the frequency (0.5 to 5 Hz), and amplitudes below" in head


@needs_compiler
def test_check_vectors_of_a_box_that_was_narrowed_still_agree():
    narrow = boxed(velocity=(0.0, 0.1))
    program = c_program(narrow, pieces_of(damper_of(narrow), narrow.model), NAME)
    assert compiler.tested(program, NAME, f"{NAME}.c")[0] is True


def variables(text: str) -> dict[str, ElementTree.Element]:
    root = ElementTree.fromstring(text.encode())
    return {v.attrib["name"]: v for v in root.iter("ScalarVariable")}


def test_the_fmu_describes_its_ranges_and_sets_no_bounds():
    pieces = pieces_of(PLAIN, "generalized")
    found = variables(description(example_card(), pieces, "unit", "{0}"))
    for name, range_ in (
        ("displacement", "up to 0.0125 m"), ("velocity", "up to 0.393 m/s"),
        ("current", "0 to 0.4 A"), ("temperature", "30 to 50 degC"),
    ):  # fmt: skip
        assert f"identified: {range_}" in found[name].attrib["description"]
        assert not {"min", "max"} & set(found[name][0].attrib)
    outside = found["outside_validity"]
    assert outside.attrib["causality"] == "output"
    assert outside[0].tag == "Boolean"
    assert "the frequency (0.5 to 5 Hz)" in outside.attrib["description"]
    cold = variables(description(boxed(temperature=None), pieces, "unit", "{0}"))
    assert "identified: none known" in cold["temperature"].attrib["description"]


@needs_compiler
def test_an_fmu_sets_its_output_and_tells_each_condition_once(tmp_path):
    fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed (extra dev)")
    from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions
    from fmpy.fmi2 import fmi2CallbackAllocateMemoryTYPE as Allocate
    from fmpy.fmi2 import fmi2CallbackFreeMemoryTYPE as Free
    from fmpy.fmi2 import fmi2CallbackLoggerTYPE as Logger

    path = tmp_path / "unit.fmu"
    path.write_bytes(fmu_of(example_card(), pieces_of(PLAIN, "generalized"), "unit").data)
    told = fmpy.read_model_description(str(path))
    number = {v.name: v.valueReference for v in told.modelVariables}
    logged: list[tuple[bytes, bytes]] = []
    slave = FMU2Slave(
        guid=told.guid, unzipDirectory=fmpy.extract(str(path), str(tmp_path / "unit")),
        modelIdentifier="unit", instanceName="one",
    )  # fmt: skip
    calls = fmi2CallbackFunctions()
    calls.logger = Logger(lambda _, name, status, category, text: logged.append((category, text)))
    calls.allocateMemory = Allocate(fmpy.calloc)
    calls.freeMemory = Free(fmpy.free)
    slave.instantiate(callbacks=calls)
    inputs = [number[z] for z in ("displacement", "velocity", "current", "temperature")]
    slave.setupExperiment()
    slave.enterInitializationMode()
    slave.setReal(inputs, [0.0, 0.0, 0.2, 40.0])
    slave.exitInitializationMode()

    def step(k: int, *values: float) -> bool:
        slave.setReal(inputs, values)
        assert slave.doStep(1e-3 * k, 1e-3) in (None, 0)
        return bool(slave.getBoolean([number["outside_validity"]])[0])

    assert not step(0, 0.002, 0.1, 0.2, 40.0)
    assert logged == []
    assert step(1, 0.002, 0.1, 2.0, 40.0)
    assert step(2, 0.002, 0.1, 2.0, 40.0)
    assert [category for category, _ in logged] == [b"outsideValidity"]
    assert b"current" in logged[0][1]
    assert b"0 to 0.4 A" in logged[0][1]
    assert step(3, 0.02, 5.0, 2.0, 200.0)
    assert [text.split()[0] for _, text in logged[1:]] == [
        b"displacement", b"velocity", b"temperature"
    ]  # fmt: skip
    assert not step(4, 0.002, 0.1, 0.2, 40.0)
    assert step(5, 0.02, 0.1, 0.2, 40.0)
    assert len(logged) == 4
    slave.terminate()
    slave.freeInstance()


@pytest.mark.parametrize("warm", [(30.0, 50.0), None])
def test_the_modelica_model_has_the_ranges_and_warns_where_a_step_does(warm):
    text = modelica_package(
        boxed(temperature=warm), pieces_of(PLAIN, "generalized"), NAME
    )["Unit.mo"]  # fmt: skip
    ranges = {
        name: float(value)
        for name, value in re.findall(r"parameter Real (\w+(?:Min|Max))\(.*?\) = (\S+) \"", text)
    }
    named = {"displacementMax": 0.0125, "velocityMax": 0.393, "currentMin": 0.0, "currentMax": 0.4}
    assert ranges == named | ({"temperatureMin": 30.0, "temperatureMax": 50.0} if warm else {})
    assert "AssertionLevel.warning" in text
    found = re.search(r"outsideValidity = (.*?);", text, re.DOTALL)
    assert found is not None
    rule = " ".join(found[1].split())
    for column, value, bit in SAMPLES:
        _, x, v, _, i, t = sample(column, value)
        inputs = {"displacement": x, "velocity": v, "current": i, "temperature": t}
        outside = eval(rule, {"abs": abs}, ranges | inputs)
        assert outside is bool(bit if warm else bit & 7)


def test_a_table_tells_what_it_was_identified_at():
    card = example_card()
    told = table_csv(table_of(card, damper_of(card)), card)
    assert "# Identified at amplitudes 12.5 to 12.5 mm, frequencies 0.5 to 5 Hz" in told
