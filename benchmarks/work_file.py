"""Work files of long studies: what is finished, one JSON object a line, so that a run goes on."""

from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path
from typing import Any, Final

from sysid.jobs.rows import add_row, read_rows

__all__ = ["FOLDER", "add_row", "each_misfit", "put_aside", "read_rows"]

FOLDER: Final = Path(__file__).parents[1] / "build"


def put_aside(file: Path, programs: Collection[str], aside: Path) -> None:
    """Leave only rows of some programs in a work file; the others go to the end of another file.

    Nobody else may write it meanwhile: `run_jobs` sees to that where this comes `first`.

    Args:
        file: Of rows; replaced, whole or not at all.
        programs: Whose rows stay.
        aside: Where the others go.
    """
    rows = read_rows(file)
    others = [row for row in rows if row.get("program") not in programs]
    if not others:
        return
    for row in others:
        add_row(row, aside)
    new = file.with_suffix(".new")
    new.unlink(missing_ok=True)
    new.touch()
    for row in rows:
        if row.get("program") in programs:
            add_row(row, new)
    new.replace(file)
    print(f"{len(others)} rows of another program were put aside into {aside}", flush=True)


def each_misfit(
    one: Callable[[int, float], dict[str, Any]],
    seeds: Sequence[int],
    misfits: Sequence[float],
    file: Path | None,
) -> Iterator[dict[str, Any]]:
    """Rows of every campaign with every misfit, the missing ones made on the way.

    Args:
        one: Makes the row of a seed and a misfit, which it holds under these names.
        seeds: Of the campaigns.
        misfits: Of the models' laws.
        file: Where rows are kept; nothing is read or kept if None.
    """
    done = {(r["seed"], r["misfit"]): r for r in (read_rows(file) if file else ())}
    for seed in seeds:
        for misfit in misfits:
            if (seed, misfit) not in done:
                row = done[seed, misfit] = one(seed, misfit)
                print(f"campaign {seed}, misfit {misfit:g}: done", flush=True)
                if file:
                    add_row(row, file)
            yield done[seed, misfit]
