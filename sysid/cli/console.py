"""What a command says, and where: results on stdout, everything else on stderr."""

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from io import TextIOWrapper
from typing import Any, Final

from rich.console import Console, RenderableType
from rich.markup import escape

ASKED_FOR: Final = "excluded by --exclude"
"""Why a test is left out that the user named."""


@dataclass(frozen=True)
class Talk:
    """How a command talks to its user.

    Colours and moving progress appear on terminals only.

    Attributes:
        json: The result goes to stdout as JSON, and nothing else does.
        quiet: No progress and no notes.
    """

    json: bool = False
    quiet: bool = False

    def note(self, text: str) -> None:
        """A remark that can be left out."""
        if not self.quiet:
            _stderr().print(escape(text), soft_wrap=True, highlight=False)

    def notes(self, sentences: Iterable[str], most: int = 20) -> None:
        """Remarks; where they are very many, the first ones and a count."""
        for text in _first(sentences, most, "remarks"):
            self.note(f"Note: {text}")

    def warn(self, text: str) -> None:
        """Something that the user must see."""
        _stderr().print(f"[yellow]Warning:[/] {escape(text)}", soft_wrap=True, highlight=False)

    def warnings(self, sentences: Iterable[str], most: int = 20) -> None:
        """What the user must see; where it is very much, the first of it and a count."""
        for text in _first(sentences, most, "warnings"):
            self.warn(text)

    def left_out(self, reasons: Mapping[str, str]) -> None:
        """Tests that are not used, each with its reason; never passed over in silence."""
        for test, reason in reasons.items():
            text = f"{test} is left out: {reason}"
            self.note(text) if reason == ASKED_FOR else self.warn(text)

    def show(self, what: RenderableType) -> None:
        """A table or text for people; left out with --json."""
        if not self.json:
            _stdout().print(what, highlight=False)

    def say(self, text: str) -> None:
        """A line for people; left out with --json."""
        if not self.json:
            _stdout().print(escape(text), soft_wrap=True, highlight=False)

    def result(self, value: Any) -> None:
        """The machine-readable result; only with --json."""
        if self.json:
            from sysid.cards.write import json_text

            out = sys.stdout
            if isinstance(out, TextIOWrapper) and not out.isatty():
                out.reconfigure(encoding="utf-8")  # as JSON is, whatever the locale
            out.write(json_text(value))
            out.flush()

    def distrust(self, reasons: Iterable[str]) -> None:
        """Say why the result must not be trusted (exit code 3)."""
        for reason in reasons:
            _stderr().print(f"[red]Do not trust this result:[/] {escape(reason)}", soft_wrap=True)

    @contextmanager
    def progress(self, text: str) -> Iterator[Callable[[str], None]]:
        """Show that something is under way; yields a callback for lines.

        On a terminal a single line changes; in a pipe, or with --quiet, nothing is shown.
        """
        console = _stderr()
        if self.quiet or not console.is_terminal:
            yield lambda line: None
            return
        with console.status(escape(text)) as status:
            yield lambda line: status.update(escape(f"{text}: {line}"))


def _first(sentences: Iterable[str], most: int, what: str) -> list[str]:
    told = list(sentences)
    rest = len(told) - most
    return told if rest <= 0 else [*told[:most], f"… and {rest} more {what}"]


def _stderr() -> Console:
    return Console(stderr=True)


def _stdout() -> Console:
    console = Console()
    if not console.is_terminal:
        console.width = 160
    return console
