"""Work that goes on: nothing is done twice, failures stop nobody, Ctrl-C loses nothing."""

import errno
import json

import pytest

from sysid.errors import OutputError, Stopped
from sysid.jobs.job import Here
from sysid.jobs.rows import add_row, read_rows
from sysid.jobs.run import _alone, run_jobs
from tests.jobs import chores


def run(folder, count, work=chores.chore, tell=lambda *_: None, prepare=chores.nothing):
    return run_jobs(
        chores.jobs(folder, count), work, Here(), folder / "rows.jsonl", chores.key,
        prepare=prepare, tell=tell,
    )  # fmt: skip


def test_finished_jobs_are_not_done_again(tmp_path):
    assert run(tmp_path, 2).new == 2
    told = []
    done = run(tmp_path, 4, tell=lambda n, of, ended: told.append((n, of, ended.key)))
    assert done.new == 2
    assert [row["square"] for row in done.rows.values()] == [0, 1, 4, 9]
    assert told == [(1, 2, "job-2"), (2, 2, "job-3")]
    assert [number for number, _ in chores.begun(tmp_path)] == [0, 1, 2, 3]
    assert list(run(tmp_path, 1).rows) == ["job-0"], "others in the file are not asked for"


def test_a_line_that_was_cut_off_is_done_again_and_spoils_no_other(tmp_path):
    run(tmp_path, 2)
    file = tmp_path / "rows.jsonl"
    file.write_bytes(file.read_bytes()[:-9])
    done = run(tmp_path, 3)
    assert done.new == 2
    assert {row["name"] for row in read_rows(file)} == {"job-0", "job-1", "job-2"}
    for line in file.read_text().splitlines()[2:]:
        json.loads(line)


def test_failures_are_listed_and_tried_again_the_next_time(tmp_path):
    done = run(tmp_path, 4, chores.picky)
    assert set(done.rows) == {"job-0", "job-3"}
    assert done.failures["job-1"] == "a.csv: is empty. Export it"
    assert "crashed in picky" in done.failures["job-2"]
    assert "ZeroDivisionError" in done.failures["job-2"]
    again = run(tmp_path, 4)
    assert (again.new, again.failures) == (2, {})


def test_ctrl_c_keeps_what_is_finished_and_says_how_to_go_on(tmp_path):
    with pytest.raises(Stopped, match=r"2 of 4 are finished and kept in .*same command goes on"):
        run(tmp_path, 4, chores.stopped)
    assert run(tmp_path, 4).new == 2


def test_two_runs_do_not_write_one_file(tmp_path):
    with (
        _alone(tmp_path / "rows.jsonl"),
        pytest.raises(OutputError, match="written by another run"),
    ):
        run(tmp_path, 1)
    assert run(tmp_path, 1).new == 1


def test_a_process_is_prepared_once(tmp_path, monkeypatch):
    monkeypatch.setenv("SYSID_TEST_PREPARED", str(tmp_path / "prepared"))
    run(tmp_path, 3, prepare=chores.mark_prepared)
    assert len((tmp_path / "prepared").read_text().splitlines()) == 1


def test_keys_must_differ(tmp_path):
    twice = [*chores.jobs(tmp_path, 1), *chores.jobs(tmp_path, 1)]
    with pytest.raises(ValueError, match="same key"):
        run_jobs(
            twice, chores.chore, Here(), tmp_path / "r", chores.key,
            prepare=chores.nothing, tell=lambda *_: None,
        )  # fmt: skip


def test_rows_have_umlauts(tmp_path):
    add_row({"größe": 1.5}, tmp_path / "new" / "rows.jsonl")
    assert read_rows(tmp_path / "new" / "rows.jsonl") == [{"größe": 1.5}]


def test_what_comes_first_may_replace_the_file_and_nobody_else_writes_meanwhile(tmp_path):
    file = tmp_path / "rows.jsonl"

    def replaced() -> None:
        (tmp_path / "new").write_text("")
        (tmp_path / "new").replace(file)

    def refused() -> None:
        raise AssertionError("came first although another run writes the file")

    with _alone(file, replaced):
        for _ in range(2):
            with pytest.raises(OutputError, match="written by another run"), _alone(file, refused):
                pass
    with _alone(file):
        pass


def test_a_file_that_was_replaced_before_it_was_locked_is_opened_again(tmp_path, monkeypatch):
    fcntl = pytest.importorskip("fcntl")
    file, real = tmp_path / "rows.jsonl", fcntl.flock

    def late(lock, how):
        monkeypatch.undo()
        (tmp_path / "new").write_text("")
        (tmp_path / "new").replace(file)
        real(lock, how)

    monkeypatch.setattr(fcntl, "flock", late)
    with (
        _alone(file),
        pytest.raises(OutputError, match="written by another run"),
        _alone(file),
    ):
        pass


def test_a_file_system_without_locks_is_no_other_run(tmp_path, monkeypatch):
    fcntl = pytest.importorskip("fcntl")

    def unknown(*_):
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "flock", unknown)
    assert run(tmp_path, 2).new == 2
