"""`sysid trials`: is the diagnosis right? Effects are hidden, diagnosed and scored."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sysid.cli.console import Talk
from sysid.cli.options import Json, Quiet
from sysid.cli.workers import SchedulerOption, Workers, pool, prepare_to_diagnose, teller

if TYPE_CHECKING:
    from sysid.jobs.job import Ended
    from sysid.trials.page import Page, Result
    from sysid.trials.plan import Plan


def trials(
    plan: Annotated[
        Path | None,
        typer.Argument(
            metavar="PLAN", help="A TOML file with tables [\\[trials]]; the full study without it."
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="DIR", help="Folder for the results; what it holds goes on."
        ),
    ] = None,
    regime: Annotated[
        list[str] | None,
        typer.Option(
            help="Instead of a plan: none, none_misfit, one, one_misfit, two, outside, bouc_wen, "
            "invisible, history or physical; repeatable."
        ),
    ] = None,
    count: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="Trials of each regime.")
    ] = None,
    one: Annotated[
        str | None,
        typer.Option(
            metavar="ID", help="Run this one trial, e.g. one:30003, and say what was hidden, what "
            "was answered and how that is judged.",
        ),
    ] = None,
    rows: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Run nothing: make page and numbers of these results."),
    ] = None,
    workers: Workers = None,
    scheduler: SchedulerOption = None,
    json: Json = False,
    seed: Annotated[
        int, typer.Option("--seed", min=0, help="Pass over so many trials of each regime.")
    ] = 0,
    quiet: Quiet = False,
) -> None:  # fmt: skip
    """Hide effects in virtual campaigns, diagnose, open the truth, score: rates with intervals.

    Writes plan.json (plan and thresholds, sealed before the first answer), trials.jsonl (one line a
    trial), trials.json and trials.md into DIR. The same command goes on where it was stopped.
    Exit code 3 where some trials could not be run.
    """
    talk = Talk(json, quiet)
    if one is not None:
        if any((plan, output, regime, count, rows, workers, scheduler, seed)):
            raise typer.BadParameter(
                "runs a single trial and writes nothing; leave PLAN and all other options out",
                param_hint="--one",
            )
        _one(talk, one)
        return
    if output is None:
        raise typer.BadParameter("give a folder for the results", param_hint="--output / -o")
    if plan is not None and (regime or count):
        raise typer.BadParameter("give PLAN or --regime and --count, not both", param_hint="PLAN")
    if plan is not None and seed:
        raise typer.BadParameter("a plan says itself where it begins: first = …", param_hint="PLAN")
    if rows is not None and any((plan, regime, count, workers, scheduler, seed)):
        raise typer.BadParameter(
            "runs nothing; leave out PLAN and all that says how trials are run",
            param_hint="--rows",
        )

    from sysid.data.whole_file import need_writable
    from sysid.trials.plan import full_plan, read_plan
    from sysid.trials.trial_id import BLOCK

    if seed + (count or 1) > BLOCK:
        raise typer.BadParameter(
            f"a regime has {BLOCK} trials, those that are passed over among them",
            param_hint="--count / --seed",
        )
    need_writable(output)
    if rows is not None:
        _page_of(talk, rows, output)
        return
    chosen = full_plan(regime or (), count, seed) if plan is None else read_plan(plan)
    _study(talk, chosen, output, workers, scheduler)


def _study(
    talk: Talk, plan: "Plan", output: Path, workers: int | None, scheduler: str | None
) -> None:
    from sysid.cli.soundness import unfit
    from sysid.jobs.job import Job
    from sysid.jobs.run import run_jobs
    from sysid.trials.one import counted, work_of
    from sysid.trials.page import page_of
    from sysid.trials.seal import ROWS, seal

    jobs = [Job(name, name) for name in map(str, plan.trials())]
    digest, file = seal(plan, output), output / ROWS
    talk.note(f"{len(jobs)} trials; plan and thresholds are sealed ({digest[:12]}).")
    with pool(talk, workers, scheduler, len(jobs)) as chosen:
        done = run_jobs(
            jobs, work_of(unfit), chosen, file, counted,
            prepare=prepare_to_diagnose, tell=teller(talk, words),
        )  # fmt: skip
    results = [_result(values, file) for values in done.rows.values()]
    page = page_of(results, len(jobs) - len(results), done.failures)
    page.numbers["plan_sha256"] = digest
    _write(talk, page, output)
    if done.failures:
        for name, why in done.failures.items():
            talk.warn(f"{name} could not be run: {why}")
        raise typer.Exit(3)


def _page_of(talk: Talk, file: Path, output: Path) -> None:
    """The page of results that are there."""
    from sysid.errors import DataError
    from sysid.jobs.rows import numbered_rows
    from sysid.trials.one import id_of
    from sysid.trials.page import page_of

    if not file.is_file():
        raise DataError(
            "there is no such file", where=file, advice="Give the path of a trials.jsonl"
        )
    found = {name: _result(row, f"{file}, line {number}") for number, row in numbered_rows(file)
             if (name := id_of(row)) is not None}  # fmt: skip
    if not found:
        raise DataError("holds no trials", where=file, advice="Give a trials.jsonl")
    _write(talk, page_of(list(found.values()), None, {}), output)


def _result(values: dict[str, Any], where: Path | str) -> "Result":
    """A line of results.

    Raises:
        DataError: It is none; says where it stands.
    """
    from sysid.errors import DataError
    from sysid.trials.page import result_of

    try:
        return result_of(values)
    except DataError as cause:
        raise DataError(cause.what, where=where, advice="Mend the line or remove it") from cause


def _write(talk: Talk, page: "Page", output: Path) -> None:
    from sysid.cards.write import json_text
    from sysid.data.whole_file import write_files
    from sysid.jobs.rows import strict

    numbers = strict(page.numbers)
    files = {"trials.md": page.text.encode(), "trials.json": json_text(numbers).encode()}
    write_files(files, output)
    talk.say(page.text)
    talk.say(f"Written to {output}: {', '.join(sorted(files))}")
    talk.result(numbers)


def words(ended: "Ended") -> str:
    """What was hidden and answered in a trial that has ended."""
    from sysid.trials.one import row_of
    from sysid.trials.page import answer_words

    row = row_of(ended.row or {})
    hidden = ", ".join(row.planters) or "nothing"
    return f"hidden: {hidden}; answer: {answer_words(row)}; {row.seconds:.0f} s"


def _one(talk: Talk, name: str) -> None:
    """A single trial, told."""
    from sysid.cli.soundness import unfit
    from sysid.jobs.rows import strict
    from sysid.trials.one import row_of, work_of
    from sysid.trials.page import answer_words
    from sysid.trials.trial_id import parse_id

    trial = parse_id(name)
    prepare_to_diagnose()
    with talk.progress(f"Hiding, diagnosing and scoring {name}"):
        values = work_of(unfit)(name)
    row = row_of(values)
    sizes = ", ".join(f"{p} ({s:.3g} % of the RMS force)"
                      for p, s in zip(row.planters, row.percents, strict=False))  # fmt: skip
    talk.say(f"Trial {name}: {row.loops} tests, program {values['program']}")
    beside = f"; that is: {', '.join(row.causes)}" if row.causes else ""
    if row.planters and not row.causes:
        beside = "; it was taken out" if trial.level == 0.0 else "; nothing of the catalogue"
    talk.say(f"Hidden: {sizes or 'nothing'}{beside}")
    for planter, bound in zip(row.planters, row.visibility, strict=False):
        talk.say(
            f"Bound of {planter}: d′ {bound.distance:.1f}, nearest rival {bound.rival or 'none'} "
            f"(|cos| {bound.likeness:.2f}), right name at best {bound.right:.0%}"
        )
    talk.say(f"Answered on {row.base or 'no base'}: {answer_words(row)}")
    if row.score is not None:
        talk.say(f"Judged: {_verdict(row)}")
    talk.result(strict(values))


def _verdict(row: Any) -> str:
    from sysid.trials.trial_id import PHYSICAL

    score = row.score
    if not row.planters or (row.regime == PHYSICAL and not score.found):  # or it was taken out
        return "a false name was given" if score.false_alarm else "no false name was given"
    if not row.causes:
        return "named outside its family" if score.outside_family else "nothing foreign was named"
    told = ", ".join(f"{c}: {v.replace('_', ' ')}" for c, v in zip(row.causes, score.found,
                                                                   strict=False))  # fmt: skip
    return told + (f"; {score.spurious} names too many" if score.spurious else "")
