"""Lines of Markdown."""

from collections.abc import Sequence


def table_lines(head: Sequence[str], rows: Sequence[Sequence[object]]) -> list[str]:
    """A table, with the empty line before it."""
    return ["", _row(head), _row(["---"] * len(head)), *map(_row, rows)]


def _row(cells: Sequence[object]) -> str:
    return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |"
