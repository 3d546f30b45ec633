"""`sysid fit --each`: a fleet of dampers, one fit for every sub-folder."""

import csv
import hashlib
import io
import json
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import typer

from sysid.cli.fit_order import Order, fit_parts, read
from sysid.cli.workers import pool, prepare_worker, teller
from sysid.errors import FitError, SysidError
from sysid.jobs.job import Ended, Job
from sysid.jobs.run import Done, run_jobs

if TYPE_CHECKING:
    from sysid.cli.console import Talk

ROWS: Final = "fleet.jsonl"
TABLE: Final = "fleet.csv"


def fit_each(
    talk: "Talk", fleet: Path, order: Order, workers: int | None, scheduler: str | None
) -> None:
    """Fit every damper of a fleet that is not fitted yet.

    A damper is fitted again if its files, the options or the version of the program have changed.

    Args:
        talk: How to talk to the user.
        fleet: Folder of campaigns.
        order: What was asked for.
        workers: On this machine.
        scheduler: Of a cluster; its workers must see both folders under the same names.

    Raises:
        FitError: The folder holds no campaign.
        typer.Exit: 1 where a damper could not be fitted, 3 where a fit must not be trusted.
    """
    output = order.output.absolute()
    with talk.progress(f"Looking for campaigns in {fleet}"):
        folders = _campaigns(talk, fleet, output)
        prints = {name: _print(folder, order) for name, folder in folders.items()}

    def key(row: dict[str, Any]) -> str | None:
        name = row.get("name")
        same = name in prints and row.get("input") == prints[name]
        return name if same and _as_written(row, output) else None

    jobs = [
        Job(name, (replace(order, output=output), folder.absolute(), name, prints[name]))
        for name, folder in folders.items()
    ]
    show = teller(talk, lambda ended: _words(ended.row or {}))
    new: list[str] = []

    def tell(count: int, of: int, ended: Ended) -> None:
        if ended.row is not None:
            new.append(ended.key)
        show(count, of, ended)

    with pool(talk, workers, scheduler, len(jobs)) as chosen:
        done = run_jobs(
            jobs, fit_one, chosen, output / ROWS, key, prepare=prepare_worker, tell=tell
        )
    _tell_rows(talk, {name: done.rows[name] for name in sorted(new)})
    _tell(talk, done, output)


def fit_one(spec: tuple[Order, Path, str, str]) -> dict[str, Any]:
    """Fit one damper and write its files, wherever we are; its line of the table."""
    from sysid.cli.drawing import forget_parts
    from sysid.cli.left_behind import told_of_earlier
    from sysid.data.whole_file import write_files

    order, folder, name, printed = spec
    campaign, chosen = read(folder, order)
    files: dict[str, bytes] = {}
    cards = []
    for number, (_, found) in enumerate(
        fit_parts(campaign, chosen, order, order.output / name), start=1
    ):
        if found.drawn is not None and found.drawn.posterior.message.endswith("interrupted"):
            raise KeyboardInterrupt  # a damper that is half done is no finished one
        files |= found.files
        suffix = order.suffix(number)
        card = json.loads(found.files[f"card{suffix}.json"])
        cards.append(
            {
                "card": f"card{suffix}.json",
                "result": found.summary.get("result"),
                "tests": sum(1 for t in found.summary.get("tests", ()) if t["used"]),
                "distrust": list(found.distrust),
                "left_out": len(chosen.left_out),
                "at_odds": list(found.odd.ids) if found.odd else [],
                **{
                    name: found.summary.get("summary", {}).get(name)
                    for name in ("mean_nrmse", "held_out_mean_nrmse")
                },
                "parameters": [
                    {n: p[n] for n in ("symbol", "unit", "value", "low", "high", "identified")}
                    for p in card.get("parameters", ())
                ],
            }
        )
    write_files(files, order.output / name)
    forget_parts(order.output / name, files)
    earlier = told_of_earlier(order.output / name, files)
    return {
        "name": name, "input": printed, "files": sorted(f"{name}/{f}" for f in files),
        "results": {
            f"{name}/{file}": hashlib.sha256(content).hexdigest()
            for file, content in sorted(files.items()) if file.endswith(".json")
        },
        "cards": cards,
        "notes": [*campaign.notes, *chosen.doubts, *earlier], "left_out": dict(chosen.left_out),
    }  # fmt: skip


def _as_written(row: dict[str, Any], output: Path) -> bool:
    """The files of a row are there, its cards and fits as they were written.

    Another order may have written other ones in their place, and a later one be this again.
    """
    files, results, cards = (row.get(name) for name in ("files", "results", "cards"))
    if not isinstance(files, list) or not isinstance(results, dict) or not results:
        return False
    if not isinstance(cards, list) or not cards:
        return False
    try:
        return all((output / file).exists() for file in files) and all(
            hashlib.sha256((output / file).read_bytes()).hexdigest() == told
            for file, told in results.items()
        )
    except OSError:
        return False


def _campaigns(talk: "Talk", fleet: Path, output: Path) -> dict[str, Path]:
    """Sub-folders that hold a campaign, by name."""
    from sysid.data.beside import loose

    try:
        found = [p for p in sorted(fleet.iterdir()) if p.is_dir() and not p.name.startswith(".")]
    except OSError as cause:
        raise FitError(
            f"cannot be read: {cause.strerror}", where=fleet, advice="Give a folder of folders"
        ) from cause
    if not found:
        raise FitError(
            "has no sub-folders", where=fleet, advice="Leave --each out to fit this folder itself"
        )
    found = [p for p in found if not _is_output(p, output)]
    held = [p for p in found if _may_be_campaign(p)]
    without = [p.name for p in found if p not in held]
    if without:
        talk.note(f"Note: neither data files nor campaign.toml are in {', '.join(without)}")
    for told in loose(fleet):
        talk.note(f"Note: {told}")
    if not held:
        raise FitError(
            "no sub-folder holds a campaign", where=fleet, advice="Each needs data files or a "
            "campaign.toml",
        )  # fmt: skip
    return {p.name: p for p in held}


def _is_output(folder: Path, output: Path) -> bool:
    """Whether this command writes there, or an earlier one did."""
    same = os.path.realpath(folder) == os.path.realpath(output)
    return same or os.path.lexists(folder / ROWS)


def _may_be_campaign(folder: Path) -> bool:
    """Whether it should be fitted; what is wrong with its files is said when they are read."""
    from sysid.data.manifest import MANIFEST
    from sysid.data.readers import find_reader

    try:
        return (folder / MANIFEST).exists() or any(find_reader(file) for file in folder.iterdir())
    except OSError:
        return True


def _print(folder: Path, order: Order) -> str:
    """SHA-256 of a campaign's files, of what is told of others there, of options and version.

    What cannot be read counts with the reason: its fit says so, and stops no other.
    """
    from sysid import __version__

    asked = replace(order, output=Path())
    digest = hashlib.sha256(f"{__version__} {asked!r}".encode())
    try:
        files, notes = _read_files(folder.absolute())
    except OSError as cause:
        digest.update(f"\n. {cause.strerror}".encode())
        files, notes = [], ()
    for note in notes:  # wherever the fleet lies
        digest.update(os.fsencode("\n" + note.replace(str(folder.absolute()), ".")))
    for path in files:
        try:
            content = hashlib.sha256(path.read_bytes()).hexdigest()
        except OSError as cause:
            content = str(cause.strerror)
        digest.update(os.fsencode(f"\n{os.path.relpath(path, folder)} {content}"))
    return digest.hexdigest()


def _read_files(folder: Path) -> tuple[list[Path], tuple[str, ...]]:
    """What is read of a campaign, wherever its manifest says that it lies, and what is told of it.

    A row holds the notes on files that are not read: it is as old as these.
    """
    from sysid.data.folder import find_place
    from sysid.data.listing import LISTING
    from sysid.data.manifest import MANIFEST

    try:
        place = find_place(folder, None)
    except SysidError:  # it will be listed as failed: anything that changes may mend it
        return sorted(path for path in folder.rglob("*") if path.is_file()), ()
    beside = (folder / MANIFEST, folder / LISTING, place.folder / LISTING)
    return [*(path for path in beside if path.is_file()), *place.files], place.notes


def _tell_rows(talk: "Talk", rows: dict[str, dict[str, Any]]) -> None:
    """What a fit alone tells of its campaign, of the dampers that were fitted now."""
    from sysid.cli.console import ASKED_FOR

    left = {f"{n}: {t}": why for n, row in rows.items() for t, why in row["left_out"].items()}
    talk.left_out({test: why for test, why in left.items() if why != ASKED_FOR})
    asked = [f"{test} is left out: {why}" for test, why in left.items() if why == ASKED_FOR]
    talk.notes(
        [*(f"{name}: {told}" for name, row in rows.items() for told in row["notes"]), *asked]
    )


def _tell(talk: "Talk", done: Done, output: Path) -> None:
    from sysid.data.whole_file import write_text

    write_text(output / TABLE, table(done))
    for name, why in done.failures.items():
        talk.warn(f"{name} could not be fitted: {why}")
    talk.notes(_of_earlier(done, output))
    doubtful = [
        f"{name}/{card['card']}: {reason}"
        for name, row in done.rows.items()
        for card in row["cards"]
        for reason in card["distrust"]
    ]
    before = len(done.rows) - done.new
    count = f"{len(done.rows)} {'damper' if len(done.rows) == 1 else 'dampers'} fitted"
    talk.say(
        f"{count} ({before} of them before), {len(done.failures)} failed. "
        f"Written to {output}: {TABLE}, and a folder for each"
    )
    if talk.json:
        fits = {
            f"{name}/{card['card'].replace('card', 'fit')}": None
            for name, row in done.rows.items()
            for card in row["cards"]
        }
        read_back = {file: json.loads((output / file).read_text("utf-8")) for file in fits}
        talk.result({"fits": read_back, "failures": done.failures})
    if doubtful:
        talk.distrust(doubtful)
    if done.failures:
        raise typer.Exit(1)
    if doubtful:
        raise typer.Exit(3)


def _of_earlier(done: Done, output: Path) -> list[str]:
    """Results of dampers that have no line in the table that would be theirs."""
    from sysid.cli.left_behind import told_of_earlier

    folders = sorted(p for p in output.iterdir() if p.is_dir() and p.name not in done.rows)
    return [told for folder in folders for told in told_of_earlier(folder, ())]


def table(done: Done) -> str:
    """The fleet as CSV: one line a card, parameters with the ends of their intervals."""
    columns: dict[str, None] = {}
    lines: list[dict[str, object]] = []
    for name, row in sorted(done.rows.items()):
        for card in row["cards"]:
            reasons = card["distrust"]
            line: dict[str, object] = {
                "name": name, "card": card["card"],
                "verdict": f"do not trust: {'; '.join(reasons)}" if reasons else "sound",
                "tests": card["tests"], "left_out": card["left_out"],
                "at_odds": ", ".join(card.get("at_odds", ())),
                "not_determined": ", ".join(
                    p["symbol"] for p in card["parameters"] if p["identified"] is False
                ),
                "mean_nrmse": card["mean_nrmse"],
                "held_out_mean_nrmse": card["held_out_mean_nrmse"],
            }  # fmt: skip
            for p in card["parameters"]:
                unit = f" [{p['unit']}]" if p["unit"] else ""
                for what in ("value", "low", "high"):
                    head = f"{p['symbol']}{'' if what == 'value' else f' {what}'}{unit}"
                    line[head] = p[what]
            columns |= dict.fromkeys(line)
            lines.append(line)
    for name, why in done.failures.items():
        lines.append({"name": name, "verdict": f"failed: {why}"})
    text = io.StringIO()
    heads = list(columns) or ["name", "verdict"]
    out = csv.DictWriter(text, heads, restval="", lineterminator="\n")
    out.writeheader()
    out.writerows(lines)
    return text.getvalue()


def _words(row: dict[str, Any]) -> str:
    told = []
    for card in row["cards"]:
        error = card["mean_nrmse"]
        doubt = ", not to be trusted" if card["distrust"] else ""
        told.append("fitted" if error is None else f"mean RMSE/max|F| {error:.2%}{doubt}")
    return "; ".join(told)
