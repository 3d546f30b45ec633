"""A damper as C99 source: one function a piece, one step a sample, nothing allocated.

The pieces are C files of their own (`c/`), as a person would write them.  What is written here
is how they stand together: the structs of parameters and of the past, and the chain of calls
from the rod to the recorded force.  Every function takes the past and returns what follows from
it, so that equations which are solved for (springs, leaks) may be tried again and again.
"""

import textwrap
from dataclasses import dataclass
from typing import Final

from sysid.cards.export.identifier import ascii_text
from sysid.cards.export.pieces import FORMS, Number, Piece, Pieces, shared_sources
from sysid.cards.export.sources import filled, source

WIDTH: Final = 96


@dataclass(frozen=True)
class Entry:
    """A number that a user may read and set, one each for a table's values.

    Attributes:
        symbol: As in the card.
        name: In words.
        unit: SI.
        value: In that unit.
        place: Where it stands in the parameters' struct.
    """

    symbol: str
    name: str
    unit: str
    value: float
    place: str


def entries_of(pieces: Pieces) -> tuple[Entry, ...]:
    """All parameters of a damper, in the order of its struct."""
    found = []
    for piece in pieces.all:
        currents = piece.currents
        for number in piece.numbers:
            if number.field in FORMS:
                continue
            place = f"{piece.member}.{number.field}"
            if not isinstance(number.value, tuple):
                found.append(Entry(number.symbol, number.name, number.unit, number.value, place))
                continue
            for k, (current, value) in enumerate(zip(currents, number.value, strict=True)):
                symbol, name = (z.format(f"{current:g}") for z in (number.symbol, number.name))
                found.append(Entry(symbol, name, number.unit, value, f"{place}[{k}]"))
    return tuple(found)


def signal_path(pieces: Pieces) -> str:
    """Everything between the types of a sample and the public functions, as C99."""
    shared = [source(f"{name}.c") for name in ("motion", *shared_sources(pieces))]
    shared.append(source("root.c"))
    kinds: dict[str, Piece] = {piece.kind: piece for piece in pieces.all}
    own = [_struct(piece) + _source(piece) for piece in kinds.values()]
    return "\n".join([*shared, *own, _parameters(pieces), _lines(pieces), *_chain(pieces)])


def _source(piece: Piece) -> str:
    if piece.kind == "series_compliance":
        return ""
    folder = "valves" if piece.stage == "valve" else "effects"
    return source(f"{folder}/{piece.kind}.c")


def _struct(piece: Piece) -> str:
    rows = [_row(number) for number in piece.numbers]
    count = len(piece.currents)
    head = f"enum {{ {piece.kind.upper()}_CURRENTS = {count} }};\n\n" if count else ""
    return f"{head}typedef struct {{\n" + "".join(rows) + f"}} {piece.kind}_parameters;\n\n"


def _row(number: Number) -> str:
    size = f"[{len(number.value)}]" if isinstance(number.value, tuple) else ""
    name = number.name.replace(" at {} A", "").replace("{} ", "")
    return f"    double {number.field}{size}; /* {ascii_text(number.unit)}, {ascii_text(name)} */\n"


def _parameters(pieces: Pieces) -> str:
    rows = [f"    {p.kind}_parameters {p.member};\n" for p in pieces.all]
    values = ",\n".join(_values(p) for p in pieces.all)
    return (
        "/* Of the whole damper. */\ntypedef struct {\n" + "".join(rows) + "} parameters;\n\n"
        f"static const parameters OF_THE_CARD = {{\n{values},\n}};\n"
    )


def _values(piece: Piece) -> str:
    text = "{" + ", ".join(_literal(n.value) for n in piece.numbers) + "}"
    return textwrap.fill(text, WIDTH, initial_indent="    ", subsequent_indent="     ")


def _literal(value: float | tuple[float, ...]) -> str:
    if isinstance(value, tuple):
        return "{" + ", ".join(map(_literal, value)) + "}"
    return repr(float(value))


def _lines(pieces: Pieces) -> str:
    rows = [f"    {p.kind}_line {p.member};\n" for p in pieces.all if p.memory == "line"]
    return (
        "/* Past samples of delayed signals; past beyond them is told by `too_short`. */\n"
        "typedef struct {\n" + ("".join(rows) or "    int none;\n") + "} lines;\n"
    )


def _springs(pieces: Pieces) -> list[Piece]:
    return [p for p in pieces.motion if p.kind == "series_compliance" and not pieces.inner]


def _chain(pieces: Pieces) -> list[str]:
    """The functions from the valve outwards to the recorded force."""
    text = [_at_valve(pieces)]
    moving = [p for p in pieces.motion if p.kind != "series_compliance" or not pieces.inner]
    behind = "at_valve"
    for piece in reversed(moving):
        write = _spring if piece.kind == "series_compliance" else _moved
        text.append(write(piece, behind))
        behind = f"through_{piece.member}"
    return [*text, _recorded(pieces, behind)]


def _past(name: str, rows: list[str]) -> str:
    body = "".join(f"    {row};\n" for row in rows) or "    int none;\n"
    return f"typedef struct {{\n{body}}} {name}_past;\n\n"


def _head(name: str, arguments: str, kind: str = "double") -> str:
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


def _arguments(piece: Piece, *given: str) -> str:
    """Arguments of a piece's function."""
    found = [f"&p->{piece.member}", *given]
    if piece.memory == "past":
        found += [f"&past->{piece.member}", f"&next->{piece.member}"]
    if piece.memory == "line":
        found.append(f"&memory->{piece.member}")
    return ", ".join(found)


def _pasts(pieces: tuple[Piece, ...] | list[Piece]) -> list[str]:
    return [f"{p.kind}_past {p.member}" for p in pieces if p.memory == "past"]


def _unused(*names: str) -> str:
    return "".join(f"    (void){name};\n" for name in names)


def _at_valve(pieces: Pieces) -> str:
    """The valve with its laws and leaks, and the forces in parallel."""
    if pieces.own_spring is not None and (pieces.forces or pieces.leaks):
        return _behind_own_spring(pieces, pieces.own_spring)
    if pieces.leaks and not pieces.inner:
        valve, call = _beside_leak(pieces), "beside_leaks(p, m, past, next, solved)"
    else:
        valve, call = _valve(pieces), "valve_with_laws(p, m, past, next)"
    rows = _pasts([pieces.valve, *pieces.leaks, *pieces.forces])
    if pieces.leaks and not pieces.inner:
        rows.append("double lost, slope")
    body = "".join(f"    force += {p.kind}({_arguments(p, 'm')});\n" for p in pieces.forces)
    return (
        "/* ---- The damper, from the valve outwards ---- */\n\n"
        + _past("at_valve", rows)
        + valve
        + "/* Valve and the forces in parallel, N. */\n"
        + _head("at_valve", _CHAIN)
        + f"\n{{\n    double force = {call};\n    (void)solved;\n{body}"
        + "    return force;\n}\n"
    )


_CHAIN: Final = (
    "const parameters *p, const motion *m, const at_valve_past *past, at_valve_past *next, "
    "int *solved"
)


def _valve(pieces: Pieces) -> str:
    """The valve as its laws change it."""
    valve, head = pieces.valve, "/* The valve with its laws, N. */\n"
    springs = [p for p in pieces.motion if p.kind == "series_compliance"] if pieces.inner else []
    arguments = (
        "const parameters *p, const motion *m, const at_valve_past *past, at_valve_past *next"
    )
    text = head + _head("valve_with_laws", arguments) + "\n{\n"
    laws = "".join(f"    {p.kind}({_arguments(p, 'm')}, &c);\n" for p in pieces.laws)
    unused = "" if valve.memory == "past" else _unused("past", "next")
    if pieces.inner:
        inside = "".join(
            f"    c.leakage += {p.kind}({_arguments(p, 'm')});\n" for p in pieces.leaks
        )
        inside += "".join(f"    c.compliance += p->{p.member}.s_k;\n" for p in springs)
        call = f"{valve.kind}_parts({_arguments(valve, 'm', '&c')})"
        return (
            f"{text}    changes c = NO_CHANGES;\n    parts both;\n{laws}{inside}"
            f"    both = {call};\n    return both.yielding + both.viscous;\n}}\n\n"
        )
    if not laws and valve.memory == "none":
        return f"{text}{unused}    return {valve.kind}_force({_arguments(valve, 'm')});\n}}\n\n"
    call = f"{valve.kind}_parts({_arguments(valve, '&at')})"
    two = any(p.kind == "width_law_yield" for p in pieces.laws) and valve.memory == "none"
    viscous = (
        f"    yielding = both.yielding;\n    at.side = m->side * c.side_viscous;\n"
        f"    both = {call};\n    both.yielding = yielding;\n"
        if two
        else ""
    )
    declared = "    parts both;\n" + ("    double yielding;\n" if two else "")
    return (
        f"{text}    changes c = NO_CHANGES;\n    motion at = *m;\n{declared}{unused}{laws}"
        f"    at.side = m->side * c.side_yielding;\n    both = {call};\n{viscous}"
        "    return c.yielding * both.yielding + c.viscous * both.viscous;\n}\n\n"
    )


def _behind_own_spring(pieces: Pieces, spring: Piece) -> str:
    """Valve, leaks and forces in parallel behind a spring that the valve takes as its own.

    Of the forces in parallel, P, the valve feels no more than that the spring gives by s P.  So P
    is found first, beside the force of the valve alone, and then the valve anew.
    """
    leaks = "".join(
        f"    c.leakage += {p.kind}({_arguments(p, 'leak_at')});\n" for p in pieces.leaks
    )
    laws = "".join(f"    {p.kind}({_arguments(p, 'm')}, &c);\n" for p in pieces.laws)
    own = (
        _past("own", _pasts([pieces.valve, *pieces.leaks]))
        + "/* The valve with laws, leaks and spring, N; leaks go by a motion of their own. */\n"
        + _head(
            "own_valve",
            "const parameters *p, const motion *m, const motion *leak_at, const own_past *past, "
            "own_past *next",
        )
        + "\n{\n    changes c = NO_CHANGES;\n    parts both;\n    (void)leak_at;\n"
        f"{laws}{leaks}"
        f"    c.compliance = p->{spring.member}.s_k;\n"
        f"    both = {pieces.valve.kind}_parts({_arguments(pieces.valve, 'm', '&c')});\n"
        "    return both.yielding + both.viscous;\n}\n\n"
    )
    forces = "".join(f"    force += {p.kind}({_arguments(p, 'm')});\n" for p in pieces.forces)
    rows = ["own_past alone, own", "carried of_valve, of_parallel"]
    beside, moved = "", "    motion moved = *m;\n"
    parallel = ""
    if pieces.forces:
        rows.append(f"through_{spring.member}_past spring")
        parallel = (
            _past("parallel", _pasts(pieces.forces))
            + "/* The forces in parallel, N. */\n"
            + _head(
                "parallel",
                "const parameters *p, const motion *m, const parallel_past *past, "
                "parallel_past *next, int *solved",
            )
            + f"\n{{\n    double force = 0.0;\n{_unused('past', 'next', 'solved')}{forces}"
            "    return force;\n}\n\n" + _spring(spring, "parallel") + "\n"
        )
        beside = (
            f"    beside = through_{spring.member}(p, NULL, &inner, &past->spring, &next->spring,\n"
            "                                       solved);\n"
            "    moved = behind_spring(s_k, beside, m, &past->of_parallel, &next->of_parallel);\n"
            "    inner.x += next->spring.solution[1].offset;\n"
        )
    return (
        "/* ---- The damper, from the valve outwards ---- */\n\n"
        + source("own_spring.c")
        + "\n"
        + own
        + parallel
        + _past("at_valve", rows)
        + "/* Valve and the forces in parallel, N. */\n"
        + _head("at_valve", _CHAIN)
        + f"\n{{\n    double s_k = p->{spring.member}.s_k, beside = 0.0;\n"
        "    double alone = own_valve(p, m, m, &past->alone, &next->alone);\n"
        "    motion inner = behind_spring(s_k, alone, m, &past->of_valve, &next->of_valve);\n"
        f"{moved}    (void)solved;\n{beside}"
        "    return own_valve(p, &moved, &inner, &past->own, &next->own) + beside;\n}\n"
    )


def _beside_leak(pieces: Pieces) -> str:
    """The valve at the speed w that leaks leave to it: w + k F(w) = v."""
    leaks = "".join(
        f"    search.leakage += {p.kind}({_arguments(p, 'm')});\n" for p in pieces.leaks
    )
    return (
        _valve(pieces)
        + """/* What is left of the speed by leaks: w + k F(w) = v. */
typedef struct {
    const parameters *p;
    motion at;
    double leakage, velocity, force;
    const at_valve_past *past;
    at_valve_past *next;
} leak_search;

static double excess_speed(double w, void *about)
{
    leak_search *s = about;
    s->at.v = w;
    s->force = valve_with_laws(s->p, &s->at, s->past, s->next);
    return w + s->leakage * s->force - s->velocity;
}

"""
        + _head("beside_leaks", _CHAIN)
        + f"""
{{
    leak_search search = {{p, *m, 0.0, m->v, 0.0, past, next}};
    int found;
    double start = m->first ? m->v : m->v - past->lost, slope = m->first ? 1.0 : past->slope, w;
{leaks}    w = root_of(excess_speed, &search, start, &slope, 1.0e-12 * fabs(m->v), &found);
    *solved = *solved && found;
    excess_speed(w, &search);
    next->lost = m->v - w;
    next->slope = slope;
    return search.force;
}}

"""
    )


def _moved(piece: Piece, behind: str) -> str:
    """A motion effect, and everything behind it."""
    name = f"through_{piece.member}"
    arguments = (
        f"const parameters *p, lines *memory, const motion *m, const {name}_past *past, "
        f"{name}_past *next, int *solved"
    )
    rows = [*_pasts([piece]), f"{behind}_past behind"]
    carried = piece.kind == "backlash_loose"
    lines = "" if behind == "at_valve" else "memory, "
    inner = "m" if carried else "&moved"
    call = f"{behind}(p, {lines}{inner}, &past->behind, &next->behind, solved)"
    if carried:
        body = f"    double force = {call};\n    return {piece.kind}({_carried(piece)});\n"
    else:
        moved = f"{piece.kind}({_arguments(piece, 'm')})"
        body = f"    motion moved = {moved};\n    return {call};\n"
    unused = _unused("memory") if not lines and piece.memory != "line" else ""
    return f"{_past(name, rows)}{_head(name, arguments)}\n{{\n{unused}{body}}}\n"


def _carried(piece: Piece) -> str:
    return _arguments(piece, "force", "m")


def _spring(piece: Piece, behind: str) -> str:
    """A spring, and everything behind it."""
    lines = "" if behind in ("at_valve", "parallel") else "s->memory, "
    marks = {"MEMBER": piece.member, "BEHIND": behind, "LINES": lines}
    return filled("spring.c", marks)


def _recorded(pieces: Pieces, behind: str) -> str:
    """From a sample to the recorded force."""
    rows = [*_pasts([*pieces.drive, *pieces.channel]), f"{behind}_past behind"]
    drive = "".join(f"    at.i = {p.kind}({_arguments(p, '&at')});\n" for p in pieces.drive)
    channel = "".join(
        f"    force = {p.kind}({_arguments(p, 'force', '&at')});\n" for p in pieces.channel
    )
    lines = "" if behind == "at_valve" else "memory, "
    used = lines or any(p.memory == "line" for p in pieces.channel)
    short = "".join(
        f"    *short_line = *short_line || {place}.too_short;\n" for place in _delay_lines(pieces)
    )
    return (
        _past("whole", rows)
        + "/* The recorded force, N. */\n"
        + _head(
            "recorded_force",
            "const parameters *p, lines *memory, const motion *m, const whole_past *past, "
            "whole_past *next, int *solved, int *short_line",
        )
        + "\n{\n    motion at = *m;\n    double force;\n"
        + ("" if used else _unused("memory"))
        + f"    *short_line = 0;\n{drive}"
        + f"    force = {behind}(p, {lines}&at, &past->behind, &next->behind, solved);\n"
        + f"{channel}{short}    return force;\n}}\n"
    )


def _delay_lines(pieces: Pieces) -> list[str]:
    found = []
    for piece in pieces.all:
        if piece.kind == "velocity_delay":
            found.append(f"memory->{piece.member}.place")
        elif piece.memory == "line":
            found.append(f"memory->{piece.member}")
    return found
