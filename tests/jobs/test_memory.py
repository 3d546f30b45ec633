"""A process that does many pieces of work does not keep all of their programs."""

import os
import sys
from types import SimpleNamespace

import jax
import jax.numpy as jnp
import pytest

from sysid.jobs import memory
from sysid.jobs.job import Here, Job


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux tells in /proc")
def test_resident_memory_is_told():
    before = memory.resident()
    assert before is not None
    held = bytearray(200_000_000)
    held[::4096] = b"x" * len(held[::4096])
    now = memory.resident()
    assert now is not None
    assert now - before > 150_000_000


def test_programs_are_forgotten_above_the_limit_only():
    double = jax.jit(lambda x: 2.0 * x)
    double(jnp.ones(3))
    held = memory.resident()
    if held is None:
        assert not memory.forget_programs(0)
        return
    assert not memory.forget_programs(10 * held)
    assert double._cache_size() == 1
    assert memory.forget_programs(held // 10)
    assert double._cache_size() == 0
    assert float(double(jnp.ones(3))[0]) == 2.0


@pytest.mark.parametrize(
    ("gigabytes", "cores", "expected"),
    [(8, 4, memory.LEAST), (24, 2, 7_200_000_000), (128, 16, 4_800_000_000)],
)
def test_a_process_may_hold_its_share_of_the_machine(monkeypatch, gigabytes, cores, expected):
    known = {"SC_PHYS_PAGES": gigabytes * 250_000, "SC_PAGE_SIZE": 4000}
    monkeypatch.setattr(os, "sysconf", known.__getitem__, raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: cores)
    assert memory.allowed() == expected


@pytest.mark.parametrize(
    ("limit", "expected"), [(1_900_000_000, 1_330_000_000), (64_000_000_000, None), (0, None)]
)
def test_a_worker_forgets_before_it_would_be_ended(monkeypatch, limit, expected):
    alone = memory.allowed()
    worker = SimpleNamespace(memory_manager=SimpleNamespace(memory_limit=limit))
    monkeypatch.setitem(sys.modules, "distributed", SimpleNamespace(get_worker=lambda: worker))
    assert memory.allowed() == (alone if expected is None else expected)


def test_what_is_no_worker_has_no_limit(monkeypatch):
    def nobody():
        raise ValueError("No worker found")

    alone = memory.allowed()
    monkeypatch.setitem(sys.modules, "distributed", SimpleNamespace(get_worker=nobody))
    assert memory.allowed() == alone


def test_a_machine_that_does_not_tell_its_memory_gets_the_least(monkeypatch):
    def unknown(name):
        raise ValueError(name)

    monkeypatch.setattr(os, "sysconf", unknown, raising=False)
    assert memory.allowed() == memory.LEAST


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux tells in /proc")
def test_memory_really_falls():
    @jax.jit
    def program(x):
        for _ in range(40):
            x = jnp.sin(x) @ jnp.ones((8, 8)) + jnp.tanh(x)
        return x

    before = memory.resident()
    for rows in range(3, 23):
        program(jnp.ones((rows, 8))).block_until_ready()
    full = memory.resident()
    assert before is not None
    assert full is not None
    assert memory.forget_programs(0)
    after = memory.resident()
    assert after is not None
    assert full - after > 0.5 * (full - before) > 5e6


def work(spec: int) -> dict[str, int]:
    if spec == 2:
        raise ValueError("no")
    return {"spec": spec}


def test_every_job_is_followed_by_it_also_one_that_failed(monkeypatch):
    asked = []
    monkeypatch.setattr("sysid.jobs.job.forget_programs", lambda: asked.append(1))
    jobs = [Job(str(k), k) for k in range(4)]
    ended = list(Here().results(jobs, work, lambda: None))
    assert len(asked) == 4
    assert [e.failure is None for e in ended] == [True, True, False, True]
