"""Real worker processes: one is killed in the middle, the scheduler is started anew, and so on."""

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections import Counter
from contextlib import contextmanager

import pytest

from sysid.errors import ClusterError
from sysid.jobs.cluster import AHEAD, ONE_THREAD, Cluster
from sysid.jobs.job import Job
from sysid.jobs.rows import read_rows
from sysid.jobs.run import run_jobs
from tests.jobs import chores

pytest.importorskip("distributed")
# warnings and stray sockets of Dask are not ours
pytestmark = pytest.mark.filterwarnings("default")


def run(pool, folder, count, seconds=0.0, work=chores.chore, tell=lambda *_: None):
    return run_jobs(
        chores.jobs(folder, count, seconds), work, pool, folder / "rows.jsonl", chores.key,
        prepare=chores.nothing, tell=tell,
    )  # fmt: skip


def run_in_time(pool, folder, seconds=120.0):
    """Rows of two jobs, or none where nobody has done them by then."""
    rows: list[dict] = []
    work = threading.Thread(target=lambda: rows.extend(run(pool, folder, 2).rows.values()))
    work.daemon = True
    work.start()
    work.join(seconds)
    return rows


@pytest.fixture(scope="module")
def two():
    with Cluster(workers=2) as cluster:
        yield cluster


def test_two_workers_share_the_work_and_one_is_killed_in_the_middle(two, tmp_path):
    def kill_one(n, of, ended):
        if n == 10:
            begun = chores.begun(tmp_path)
            os.kill(begun[-1][1], signal.SIGKILL)  # it has just begun something

    before = set(two.pids)
    done = run(two, tmp_path, 20, 0.1, tell=kill_one)
    assert (done.new, done.failures) == (20, {})
    assert [row["square"] for row in done.rows.values()] == [k**2 for k in range(20)]
    rows = Counter(row["name"] for row in read_rows(tmp_path / "rows.jsonl"))
    assert set(rows.values()) == {1}, "a result is written once"
    times = Counter(number for number, _ in chores.begun(tmp_path))
    assert len(times) == 20
    assert 1 <= sum(times.values()) - 20 <= 2, "only what the dead worker had is begun again"
    assert len(before & {row["pid"] for row in done.rows.values()}) == 2
    assert os.getpid() not in before


def test_a_job_that_kills_every_worker_is_a_failure_of_its_own(two, tmp_path):
    done = run(two, tmp_path, 4, work=chores.deadly)
    assert list(done.failures) == ["job-1"]
    assert "every worker that tried it died" in done.failures["job-1"]
    assert len(done.rows) == 3


def test_a_job_beside_one_that_kills_is_not_taken_for_it(two, tmp_path):
    """Dask suspects everything that lay with a dead worker."""
    jobs = [Job(f"job-{k}", (str(tmp_path), 1 if k < 2 else k, 0.3)) for k in range(8)]
    done = run_jobs(
        jobs, chores.deadly_after_a_while, two, tmp_path / "rows.jsonl", chores.key,
        prepare=chores.nothing, tell=lambda *_: None,
    )  # fmt: skip
    assert sorted(done.failures) == ["job-0", "job-1"]
    assert sorted(done.rows) == [f"job-{k}" for k in range(2, 8)]


def test_workers_that_dask_has_given_up_are_started_anew(tmp_path):
    """It closes a dead one's nanny after a while, which a busy machine needs to start it again."""
    import dask

    with (
        dask.config.set({"distributed.deploy.lost-worker-timeout": "10ms"}),
        Cluster(workers=1) as cluster,
    ):
        before = cluster.pids
        os.kill(before[0], signal.SIGKILL)
        local, end = cluster._local, time.monotonic() + 30.0
        assert local is not None
        while local.workers and time.monotonic() < end:
            time.sleep(0.05)
        assert not local.workers, "Dask has given it up"
        # the dead one's nanny may start a worker yet before it is closed: what counts is the work
        rows = run_in_time(cluster, tmp_path)
        assert len(rows) == 2
        assert not {row["pid"] for row in rows} & {*before}


@pytest.mark.parametrize("status", ["failed", "closed"])
def test_a_worker_that_could_not_start_is_not_waited_for(status, tmp_path):
    """A dead worker's name may be taken for a moment: then the one in its place fails."""
    import dask
    from distributed import Status

    with (
        dask.config.set({"distributed.deploy.lost-worker-timeout": "10ms"}),
        Cluster(workers=1) as cluster,
    ):
        local, end = cluster._local, time.monotonic() + 30.0
        assert local is not None
        nanny = local.workers[0]
        local.sync(nanny.close)
        while local.workers and time.monotonic() < end:
            time.sleep(0.05)
        nanny.status = Status[status]
        local.workers[0] = nanny
        assert len(run_in_time(cluster, tmp_path)) == 2


def test_failures_and_sentences_come_back_from_workers(two, tmp_path):
    done = run(two, tmp_path, 4, work=chores.picky)
    assert done.failures["job-1"] == "a.csv: is empty. Export it"
    assert "crashed in picky" in done.failures["job-2"]
    assert len(done.rows) == 2


def test_a_worker_uses_one_thread(two):
    for worker in two._client.run(chores.environment).values():
        assert {name: worker.get(name) for name in ONE_THREAD} == ONE_THREAD
    for found in two._client.run(chores.memory_rules).values():
        assert not any(found.values()), "a worker that pauses would wait for ever"


def test_few_jobs_are_under_way_at_once(two, tmp_path):
    """Ten thousand specs do not wait in the scheduler."""
    most = []

    def look(n, of, ended):
        most.append(len(two._client.futures))

    run(two, tmp_path, 40, 0.01, tell=look)
    assert max(most) <= AHEAD * 2 + 1


def free_port() -> int:
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


@contextmanager
def scheduler_and_worker(port):
    """Both as a user starts them."""
    address = f"tcp://127.0.0.1:{port}"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    python = [sys.executable, "-m", "distributed.cli"]
    both = [
        subprocess.Popen(
            [python[0], "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1",
             "--port", str(port), "--no-dashboard"], **quiet
        ),
        subprocess.Popen(
            [python[0], "-m", "distributed.cli.dask_worker", address, "--nthreads", "1",
             "--no-nanny", "--no-dashboard"], **quiet
        ),
    ]  # fmt: skip
    try:
        yield address, both
    finally:
        for one in both:
            one.kill()
            one.wait()


def test_a_scheduler_that_is_started_anew_goes_on(tmp_path):
    port, told = free_port(), []
    anew = threading.Event()

    def kill(n, of, ended):
        if n == 3:
            for one in first:
                one.kill()
                one.wait()
            anew.set()

    def start_again():
        anew.wait(30)
        with scheduler_and_worker(port):
            finished.wait(60)

    finished = threading.Event()
    second = threading.Thread(target=start_again)
    with scheduler_and_worker(port) as (address, first):
        second.start()
        try:
            with Cluster(address=address, patience=40.0, warn=told.append) as cluster:
                done = run(cluster, tmp_path, 8, 0.05, tell=kill)
        finally:
            anew.set()
            finished.set()
            second.join()
    assert (len(done.rows), done.failures) == (8, {})
    assert [len(read_rows(tmp_path / "rows.jsonl"))] == [8]
    # a count of the workers may come first and find none: its sentence then stands before this one
    assert any("lost" in one for one in told), told


def test_without_a_scheduler_there_is_one_sentence_and_what_is_finished_is_kept(tmp_path):
    port = free_port()
    with pytest.raises(ClusterError, match=r"no Dask scheduler answers.*Start it"):
        Cluster(address=f"tcp://127.0.0.1:{port}", patience=0.5)._connect(0.6)

    def kill(n, of, ended):
        for one in both:
            one.kill()
            one.wait()

    with scheduler_and_worker(port) as (address, both):
        begin = time.monotonic()
        with (
            pytest.raises(ClusterError, match="what is finished is kept"),
            Cluster(address=address, patience=0.5, warn=lambda _: None) as cluster,
        ):
            run(cluster, tmp_path, 5, tell=kill)
        assert time.monotonic() - begin < 60
    assert len(read_rows(tmp_path / "rows.jsonl")) >= 1


@pytest.mark.parametrize("address", ["foo", "http://x", "tcp://host", ""])
def test_what_is_no_address_is_told_at_once(address, monkeypatch):
    def tried(*_, **__):
        raise AssertionError("a client would try it for long")

    monkeypatch.setattr("distributed.Client", tried)
    with (
        pytest.raises(ClusterError, match=r"is no address of a Dask scheduler .*tcp://HOST:8786"),
        Cluster(address=address),
    ):
        pass
