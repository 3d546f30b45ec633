"""What the functions of an exported damper are written with: structs of the past, heads, calls."""

from typing import Final

from sysid.cards.export.pieces import Piece
from sysid.cards.export.sources import filled

WIDTH: Final = 96
"""Of a line."""
CHAIN: Final = (
    "const parameters *p, const motion *m, const at_valve_past *past, at_valve_past *next, "
    "int *solved"
)


def past_struct(name: str, rows: list[str]) -> str:
    """A struct of what is remembered."""
    body = "".join(f"    {row};\n" for row in rows) or "    int none;\n"
    return f"typedef struct {{\n{body}}} {name}_past;\n\n"


def head(name: str, arguments: str, kind: str = "double") -> str:
    """The head of a function."""
    return _wrapped(f"static {kind} {name}({arguments})")


def _wrapped(line: str) -> str:
    """A function's head, its arguments under each other where the line is too long."""
    indent, lines = " " * (line.index("(") + 1), [""]
    for k, word in enumerate(line.split(", ")):
        joint = ", " if k else ""
        if k and len(lines[-1]) + len(joint) + len(word) > WIDTH:
            lines[-1] += ","
            lines.append(indent + word)
        else:
            lines[-1] += joint + word
    return "\n".join(lines)


def arguments_of(piece: Piece, *given: str) -> str:
    """Arguments of a piece's function."""
    found = [f"&p->{piece.member}", *given]
    if piece.memory == "past":
        found += [f"&past->{piece.member}", f"&next->{piece.member}"]
    if piece.memory == "line":
        found.append(f"&memory->{piece.member}")
    return ", ".join(found)


def past_rows(pieces: tuple[Piece, ...] | list[Piece]) -> list[str]:
    """Rows of a struct for the pieces that have a past."""
    return [f"{p.kind}_past {p.member}" for p in pieces if p.memory == "past"]


def unused(*names: str) -> str:
    """Statements that tell a compiler so."""
    return "".join(f"    (void){name};\n" for name in names)


def spring(piece: Piece, behind: str) -> str:
    """A spring, and everything behind it."""
    lines = "" if behind in ("at_valve", "parallel") else "s->memory, "
    marks = {"MEMBER": piece.member, "BEHIND": behind, "LINES": lines}
    return filled("spring.c", marks)
