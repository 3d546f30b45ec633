"""What every benchmark leaves behind: a Markdown page and the numbers as JSON."""

import argparse
import json
import os
import platform
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

from sysid.trials.markdown import table_lines

RESULTS = Path(__file__).parent / "results"
LIBRARIES = ("numpy", "scipy", "jax", "optimistix")


@dataclass
class Outcome:
    """Page and numbers of one benchmark, filled on the way.

    Attributes:
        name: Stem of the files.
        title: Heading.
        numbers: For JSON.
        lines: Of the page, under the heading.
    """

    name: str
    title: str
    numbers: dict[str, Any] = field(default_factory=dict)
    lines: list[str] = field(default_factory=list)

    def say(self, *sentences: str) -> None:
        """Add a paragraph."""
        self.lines += ["", " ".join(sentences)]

    def table(self, head: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
        """Add a table."""
        self.lines += table_lines(head, rows)

    def finish(self, *, keep: bool = True) -> str:
        """Print the page; write `results/NAME.md` and `.json` unless it was a quick run."""
        page = "\n".join([f"# {self.title}", *self.lines, "", f"On {machine()}.", ""])
        print(page)
        if keep:
            RESULTS.mkdir(exist_ok=True)
            (RESULTS / f"{self.name}.md").write_text(page, encoding="utf-8")
            numbers = {"machine": machine(), **self.numbers}
            text = json.dumps(numbers, indent=1, ensure_ascii=False) + "\n"
            (RESULTS / f"{self.name}.json").write_text(text, encoding="utf-8")
        return page


def machine() -> str:
    """Cores, threads, Python and libraries, in words."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    names = ", ".join(f"{name} {version(name)}" for name in LIBRARIES)
    python = platform.python_version()
    blas = os.environ.get("OPENBLAS_NUM_THREADS")
    threads = "default threads" if blas is None else f"threads of BLAS: {blas}"
    return f"{cores} cores ({platform.machine()}), {threads}, Python {python}, {names}"


def arguments(about: str, campaigns: int, quick: int) -> tuple[int, bool]:
    """Read `--campaigns N` and `--quick`.

    Args:
        about: What the script does.
        campaigns: Default number.
        quick: Number with `--quick`, which also writes no files.
    """
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("--campaigns", type=int, help=f"default {campaigns}")
    parser.add_argument("--quick", action="store_true", help=f"{quick} campaigns, nothing written")
    given = parser.parse_args()
    return given.campaigns or (quick if given.quick else campaigns), given.quick
