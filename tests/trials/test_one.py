"""A trial by its name, as a worker is given it."""

import ast
import pickle

import pytest

from sysid.cli.soundness import unfit
from sysid.errors import ClusterError
from sysid.trials.one import id_of, row_of, run_one, work_of
from sysid.trials.outcome import Row
from sysid.trials.program import SOURCE, TRIALS, fingerprint, program


def test_a_worker_is_sent_a_function_and_a_name():
    work = pickle.loads(pickle.dumps(work_of(unfit)))
    assert work.keywords == {"unfit": unfit, "programs": (program(False), program(True))}


def test_a_worker_with_another_program_refuses():
    with pytest.raises(ClusterError, match=f"another program .{program(False)}, not elsewhere"):
        run_one("one:30000", unfit=unfit, programs=("elsewhere", program(True)))


def test_the_physical_tier_has_a_program_of_its_own():
    assert program(False) != program(True)
    assert program(False) == fingerprint(TRIALS, ("rig/physical",))


def test_what_a_trial_depends_on_counts_with_all_that_it_imports():
    """A module that is left out could change and rows of the former program would go on."""
    counted = {
        file
        for name in TRIALS
        for file in ((SOURCE / name).rglob("*.py") if (SOURCE / name).is_dir() else [SOURCE / name])
    }
    imported = {
        file
        for source in counted
        for node in ast.walk(ast.parse(source.read_text("utf-8")))
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("sysid.")
        for name in (node.module, *(f"{node.module}.{alias.name}" for alias in node.names))
        if (file := SOURCE.parent.joinpath(*str(name).split(".")).with_suffix(".py")).exists()
    }
    assert len(counted) > 100
    assert imported - counted == {SOURCE / "errors.py"}


def test_lines_of_results_are_rows_with_or_without_a_name():
    row = Row("one", 30000, 66, ("gas_preload",), ("force_offset",), (1.0,), 0.0)
    old = row.as_dict() | {"commit": "abc", "program": "def"}
    assert row_of(old) == row
    assert id_of(old) == "one:30000"
    assert id_of(old | {"id": "one:30000:percent=2"}) == "one:30000:percent=2"
    assert id_of({"square": 4}) is None
