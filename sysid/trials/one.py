"""One trial by its name, in whatever process."""

from functools import partial
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from sysid.errors import ClusterError, DataError, SysidError
from sysid.jobs.job import Work, crash
from sysid.jobs.rows import shortened
from sysid.trials.outcome import Row, read_row, run_trial
from sysid.trials.physical import Unfit, run_physical
from sysid.trials.program import program
from sysid.trials.trial_id import PHYSICAL, parse_id, spec_of

if TYPE_CHECKING:
    from sysid.data.loops import Loops
    from sysid.diagnosis.result import Diagnosis
    from sysid.motion.history import RunHistory


def work_of(unfit: Unfit) -> Work:
    """The function that workers are given: name of a trial → row."""
    return partial(run_one, unfit=unfit, programs=(program(False), program(True)))


def run_one(name: str, *, unfit: Unfit, programs: tuple[str, str]) -> dict[str, Any]:
    """Run a trial.

    Args:
        name: Of the trial.
        unfit: Which tests of raw data are left out.
        programs: Fingerprints (hysteretic, physical) that this process must have as well.

    Returns:
        Fields of a `Row`, and ``id`` and ``program``.

    Raises:
        DataError: There is no such trial.
        ClusterError: This worker has another program.
    """
    trial = parse_id(name)
    mine, theirs = program(trial.regime == PHYSICAL), programs[trial.regime == PHYSICAL]
    if mine != theirs:
        raise ClusterError(
            f"the worker has another program ({mine}, not {theirs})",
            advice="Install the same version of sysid there",
        )
    if trial.regime == PHYSICAL:
        row = run_physical(trial, diagnose_or_fail, unfit)
    else:
        from sysid.trials.sparse_regression import sparse_names

        row = run_trial(spec_of(trial), diagnose_or_fail, sparse_names)
    return shortened({"id": str(trial), **row.as_dict(), "program": mine})


def diagnose_or_fail(loops: "Loops", *, history: "RunHistory | None", seed: int) -> "Diagnosis":
    """A crash is no answer: it counts as one that names nothing, and does not end the study.

    Args:
        loops: L tests.
        history: Of these; None where their order is not known.
        seed: Of everything random.

    Raises:
        DataError: The diagnosis crashed.
    """
    from sysid.diagnosis.diagnose import diagnose_loops

    try:
        return diagnose_loops(loops, history=history, seed=seed)
    except SysidError:
        raise
    except Exception as error:
        raise DataError(crash(error)) from error


def id_of(values: dict[str, Any]) -> str | None:
    """The trial of a line of results; None where it is none."""
    if isinstance(values.get("id"), str):
        return values["id"]
    if "regime" in values and "seed" in values:
        return f"{values['regime']}:{values['seed']}"
    return None


def counted(values: dict[str, Any]) -> str | None:
    """The trial of a line of results that the present program made; None where it is none."""
    name = id_of(values)
    if name is None:
        return None
    physical = name.partition(":")[0] == PHYSICAL
    return name if values.get("program") == program(physical) else None


def row_of(values: dict[str, Any]) -> Row:
    """A line of results as a row; what the line has beside is left.

    Raises:
        DataError: It is none.
    """
    fields = Row.__dataclass_fields__
    try:
        return read_row({name: value for name, value in values.items() if name in fields})
    except ValidationError as cause:
        first = cause.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise DataError(
            f"{id_of(values)} is no result of a trial ({where}: {first['msg'].lower()})"
        ) from cause
