"""Work files of long studies: what is finished, one JSON object a line, so that a run goes on."""

import json
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Final

FOLDER: Final = Path(__file__).parents[1] / "build"


def finished(file: Path) -> list[dict[str, Any]]:
    """Rows of a work file; a line that was cut off when a run was stopped does not count."""
    rows = []
    for line in file.read_text("utf-8").splitlines() if file.exists() else ():
        try:
            rows.append(json.loads(line))
        except json.JSONDecodeError:
            continue
    return rows


def keep(row: dict[str, Any], file: Path) -> None:
    """Add a row, on a line of its own also where the last one was cut off."""
    file.parent.mkdir(parents=True, exist_ok=True)
    whole = not file.exists() or file.read_bytes()[-1:] in (b"", b"\n")
    with file.open("a", encoding="utf-8") as out:
        out.write(("" if whole else "\n") + json.dumps(row, ensure_ascii=False) + "\n")


def put_aside(file: Path, program: str, aside: Path) -> None:
    """Leave only rows of one program in a work file; the others go to the end of another file."""
    rows = finished(file)
    others = [row for row in rows if row.get("program") != program]
    if not others:
        return
    for row in others:
        keep(row, aside)
    new = file.with_suffix(".new")
    new.unlink(missing_ok=True)
    new.touch()
    for row in rows:
        if row.get("program") == program:
            keep(row, new)
    new.replace(file)
    print(f"{len(others)} rows of another program were put aside into {aside}", flush=True)


def shortened(value: Any, digits: int = 5) -> Any:
    """The same with floats of few digits: a long study's lines stay with the results."""
    if isinstance(value, float):
        return float(f"{value:.{digits}g}")
    if isinstance(value, dict):
        return {k: shortened(v, digits) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [shortened(v, digits) for v in value]
    return value


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
    done = {(r["seed"], r["misfit"]): r for r in (finished(file) if file else ())}
    for seed in seeds:
        for misfit in misfits:
            if (seed, misfit) not in done:
                row = done[seed, misfit] = one(seed, misfit)
                print(f"campaign {seed}, misfit {misfit:g}: done", flush=True)
                if file:
                    keep(row, file)
            yield done[seed, misfit]
