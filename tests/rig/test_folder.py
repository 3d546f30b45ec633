"""Writing a campaign whole or not at all."""

import pytest

from sysid.errors import DataError, OutputError
from sysid.rig.folder import write_folder
from sysid.rig.scenarios import find_scenario

FILES = {"a.csv": b"1\n", "sealed/truth.json": b"{}\n"}


def _content(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def test_writes_a_new_folder_and_leaves_nothing_beside_it(tmp_path):
    write_folder(FILES, tmp_path / "deep" / "campaign")
    assert _content(tmp_path / "deep") == {f"campaign/{k}": v for k, v in FILES.items()}


def test_writes_over_an_earlier_run_and_into_an_empty_folder(tmp_path):
    folder = tmp_path / "campaign"
    folder.mkdir()
    write_folder(FILES, folder)
    write_folder(FILES | {"a.csv": b"2\n"}, folder)
    assert _content(tmp_path) == {
        "campaign/a.csv": b"2\n",
        "campaign/sealed/truth.json": b"{}\n",
    }


def test_refuses_a_folder_with_other_files_and_leaves_it_alone(tmp_path):
    folder = tmp_path / "measured"
    folder.mkdir()
    (folder / "mine.csv").write_text("precious")
    with pytest.raises(OutputError, match=r"measured: the folder holds 'mine\.csv'"):
        write_folder(FILES, folder)
    assert _content(tmp_path) == {"measured/mine.csv": b"precious"}


def test_refuses_a_file_in_the_way(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("x")
    with pytest.raises(OutputError, match="is not a folder"):
        write_folder(FILES, blocked)
    with pytest.raises(OutputError, match="cannot be written"):
        write_folder(FILES, blocked / "below")
    assert _content(tmp_path) == {"file": b"x"}


def test_an_unknown_scenario_is_refused_with_those_known():
    with pytest.raises(DataError, match=r"no scenario 'w11'.*virtual-w11-low, virtual-w11-high"):
        find_scenario("w11")
