"""Chains that are killed, interrupted and resumed, against one that was left in peace."""

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from sysid.uncertainty import chain as chain_module
from sysid.uncertainty.chain import (
    BLOCK,
    Course,
    course_arrays,
    course_of,
    draws_of,
    grow,
    walk_all,
)
from sysid.uncertainty.chain_store import ChainStore
from sysid.uncertainty.convergence import convergence
from sysid.uncertainty.ensemble import Walkers, random_state
from sysid.uncertainty.jump import jump_of

N, WALKERS, PAUSE = 3, 12, 0.004
KEY = "one chain"


def target(u: np.ndarray) -> np.ndarray:
    return -0.5 * np.sum(u**2, axis=1)


def slow_target(u: np.ndarray) -> np.ndarray:
    time.sleep(PAUSE / len(u))
    return target(u)


def course(log_probability=target) -> Course:
    starts = []
    for k in range(4):
        u = np.random.default_rng(k).standard_normal((WALKERS, N))
        starts.append(Walkers(u, target(u), random_state(1, k)))
    return Course(log_probability, (jump_of(np.zeros(N), 3.0 * np.eye(N)),) * 4, tuple(starts))


def evidence_of(u: np.ndarray):
    return convergence(u, ["x", "y", "z"])


def grown(store: ChainStore | None, log_probability=target, seconds: float = 100.0):
    made = course(log_probability)
    if store is not None:
        kept = store.setup()
        if kept is None:
            store.begin(course_arrays(made))
        else:
            made = course_of(kept, log_probability)
    with ThreadPoolExecutor(2) as executor:
        deadline = time.monotonic() + seconds
        return grow(made, evidence_of, executor, deadline=deadline, store=store)


@pytest.fixture(scope="module")
def undisturbed():
    blocks, evidence, message = grown(None)
    assert message == "converged"
    assert evidence.reached
    return blocks


def same(blocks, others) -> bool:
    heights = (np.concatenate([b.log_probability for b in z], axis=1) for z in (blocks, others))
    return np.array_equal(draws_of(blocks), draws_of(others)) and np.array_equal(*heights)


def test_a_chain_that_is_killed_again_and_again_ends_as_one_left_in_peace(tmp_path, undisturbed):
    folder = tmp_path / "parts"
    program = f"import runpy; runpy.run_path({__file__!r})['run']({str(folder)!r})"
    moments = np.random.default_rng(0).uniform(0.0, 0.3, 4)
    stored = 0
    for moment in moments:
        child = subprocess.Popen([sys.executable, "-c", program])
        before = time.monotonic()
        while not (folder / f"{stored:06d}.h5").exists() and time.monotonic() < before + 60.0:
            assert child.poll() is None, "the chain ended before it could be killed"
            time.sleep(0.005)
        time.sleep(moment)
        os.kill(child.pid, signal.SIGKILL)
        child.wait()
        kept = len(ChainStore(folder, KEY).blocks())
        assert kept > stored, "a block that was stored is lost"
        stored = kept
    assert stored < len(undisturbed)
    (folder / ".sysid-half").write_bytes(b"a block that was being written")
    blocks, _, message = grown(ChainStore(folder, KEY))
    assert message == "converged"
    assert same(blocks, undisturbed)


def run(folder: str) -> None:
    grown(ChainStore(Path(folder), KEY), slow_target)


def test_an_interrupt_keeps_what_was_drawn_and_the_chain_can_go_on(
    tmp_path, undisturbed, monkeypatch
):
    calls, walk_all = [], chain_module.walk_all

    def interrupted(*arguments):
        calls.append(1)
        if len(calls) == 4:
            raise KeyboardInterrupt
        return walk_all(*arguments)

    monkeypatch.setattr(chain_module, "walk_all", interrupted)
    blocks, evidence, message = grown(ChainStore(tmp_path / "parts", KEY))
    assert message == "not converged: interrupted"
    assert not evidence.reached
    assert same(blocks, undisturbed[:3])
    blocks, _, message = grown(ChainStore(tmp_path / "parts", KEY))
    assert message == "converged"
    assert same(blocks, undisturbed)


def test_time_that_is_up_is_said_and_one_block_is_there():
    blocks, evidence, message = grown(None, seconds=-1.0)
    assert len(blocks) == 1
    assert message == "not converged: the time budget was spent"
    assert evidence.missing


def test_walking_ends_with_its_first_block_once_time_is_up_and_is_the_same_up_to_there():
    made, blocks = course(), 3
    with ThreadPoolExecutor(2) as executor:

        def walked(deadline: float):
            start, jumps = made.start, made.jumps
            return walk_all(executor, target, start, blocks * BLOCK, jumps, deadline)

        whole, late = walked(np.inf), walked(time.monotonic() - 1.0)
        in_blocks = walked(time.monotonic() + 100.0)
    for all_of_it, first, same_steps in zip(whole, late, in_blocks, strict=True):
        assert np.array_equal(first.u, all_of_it.u[:BLOCK])
        assert np.array_equal(same_steps.u, all_of_it.u)
        assert np.array_equal(same_steps.accepted, all_of_it.accepted)
        assert np.array_equal(same_steps.end.random.keys, all_of_it.end.random.keys)


def test_blocks_of_another_chain_are_not_taken_for_ones_own(tmp_path):
    grown(ChainStore(tmp_path / "parts", "another chain"), seconds=-1.0)
    store = ChainStore(tmp_path / "parts", KEY)
    assert store.setup() is None
    store.begin(course_arrays(course()))
    assert store.blocks() == []
    assert store.setup() is not None


def test_a_damaged_block_is_drawn_again(tmp_path):
    store = ChainStore(tmp_path, "one")
    store.begin({"a": np.zeros(1)})
    for k in range(3):
        store.append(k, {"u": np.full(2, k)})
    whole = (tmp_path / "000001.h5").read_bytes()
    for rest in (b"", whole[: len(whole) // 2]):
        (tmp_path / "000001.h5").write_bytes(rest)
        assert len(store.blocks()) == 1
    (tmp_path / "setup.h5").write_bytes(b"")
    assert store.setup() is None


def test_blocks_of_another_chain_are_not_taken(tmp_path):
    own, other = ChainStore(tmp_path, "one"), ChainStore(tmp_path, "another")
    own.begin({"a": np.zeros(1)})
    own.append(0, {"u": np.zeros(2)})
    other.append(1, {"u": np.ones(2)})
    own.append(2, {"u": np.zeros(2)})
    assert len(own.blocks()) == 1
    assert other.blocks() == []
    assert other.setup() is None
