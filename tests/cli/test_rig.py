"""`sysid rig` as a user runs it."""

import json
from pathlib import Path

from sysid.cli.app import run

SHIPPED = Path(__file__).parents[2] / "datasets" / "virtual-w11-asymmetric"


def _content(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*.*")}


def test_rebuilds_a_shipped_dataset(tmp_path, capsys):
    assert run(["rig", "virtual-w11-asymmetric", "-o", str(tmp_path / "a"), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert (said["tests"], said["scenario"]) == (16, "virtual-w11-asymmetric")
    assert _content(tmp_path / "a") == _content(SHIPPED)


def test_a_seed_makes_other_data_and_its_page_says_how(tmp_path):
    assert run(["rig", "virtual-w11-asymmetric", "-o", str(tmp_path / "a"), "--seed", "7"]) == 0
    made = _content(tmp_path / "a")
    assert made["12.5mm_0.5Hz_0A.csv"] != _content(SHIPPED)["12.5mm_0.5Hz_0A.csv"]
    assert "--seed 7" in made["README.md"].decode()


def test_an_unknown_scenario_ends_with_one_message_and_no_folder(tmp_path, capsys):
    assert run(["rig", "w11", "-o", str(tmp_path / "a")]) == 1
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("Error: there is no scenario 'w11'. Scenarios: virtual-w11-low")
    assert list(tmp_path.iterdir()) == []


def test_measured_data_in_the_folder_are_left_alone(tmp_path, capsys):
    (tmp_path / "mine.csv").write_text("precious")
    assert run(["rig", "virtual-w11-low", "-o", str(tmp_path)]) == 1
    assert "'mine.csv'" in capsys.readouterr().err
    assert _content(tmp_path) == {"mine.csv": b"precious"}


def test_measured_files_of_the_same_names_are_left_alone(tmp_path, capsys):
    assert run(["rig", "virtual-w11-low", "-o", str(tmp_path / "virtual")]) == 0
    name = sorted(p.name for p in (tmp_path / "virtual").glob("*.csv"))[0]
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / name).write_text("precious")
    assert run(["rig", "virtual-w11-low", "-o", str(tmp_path / "mine")]) == 1
    assert f"'{name}', which no virtual campaign left" in capsys.readouterr().err
    assert _content(tmp_path / "mine") == {name: b"precious"}
    assert run(["rig", "virtual-w11-low", "-o", str(tmp_path / "virtual")]) == 0
