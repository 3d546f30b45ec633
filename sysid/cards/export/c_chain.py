"""The functions of an exported damper from the valve outwards to the recorded force, as C99."""

from sysid.cards.export.c_own_spring import behind_own_spring
from sysid.cards.export.c_parts import (
    CHAIN,
    arguments_of,
    head,
    past_rows,
    past_struct,
    spring,
    unused,
)
from sysid.cards.export.pieces import Piece, Pieces


def chain(pieces: Pieces) -> list[str]:
    """The functions from the valve outwards to the recorded force."""
    text = [_at_valve(pieces)]
    moving = [p for p in pieces.motion if p.kind != "series_compliance" or not pieces.inner]
    behind = "at_valve"
    for piece in reversed(moving):
        write = spring if piece.kind == "series_compliance" else _moved
        text.append(write(piece, behind))
        behind = f"through_{piece.member}"
    return [*text, _recorded(pieces, behind)]


def _at_valve(pieces: Pieces) -> str:
    """The valve with its laws and leaks, and the gas and other forces in parallel."""
    if pieces.own_spring is not None and (pieces.forces or pieces.leaks):
        return behind_own_spring(pieces, pieces.own_spring)
    loop, known = _loop(pieces), ""
    if pieces.leaks and not pieces.inner:
        valve, call = _beside_leak(pieces), "beside_leaks(p, m, past, next, solved)"
    else:
        given = "&loop, " if loop else ""
        valve, call = _valve(pieces), f"valve_with_laws(p, {given}m, past, next)"
    rows = past_rows([pieces.valve, *pieces.leaks, *pieces.forces])
    if pieces.leaks and not pieces.inner:
        rows.append("double ahead, left, slope")
    elif loop:
        known = f"    {loop} loop = {loop}_of(&p->{pieces.valve.member}, m);\n"
    beside = [f"{p.kind}({arguments_of(p, 'm')})" for p in pieces.forces]
    if pieces.gas:
        beside.insert(0, f"{pieces.valve.kind}_gas(&p->{pieces.valve.member}, m)")
    body = "".join(f"    force += {call};\n" for call in beside)
    return (
        "/* ---- The damper, from the valve outwards ---- */\n\n"
        + past_struct("at_valve", rows)
        + valve
        + "/* Valve and the forces in parallel, N. */\n"
        + head("at_valve", CHAIN)
        + f"\n{{\n{known}    double force = {call};\n    (void)solved;\n{body}"
        + "    return force;\n}\n"
    )


def _loop(pieces: Pieces) -> str:
    """Type of what current and peak speed alone tell of a valve without memory; empty with memory.

    Searches for a velocity compute it once.  Laws need it at the current and at 0 A.
    """
    if pieces.valve.memory == "past":
        return ""
    return f"{pieces.valve.kind}_loops" if pieces.laws else f"{pieces.valve.kind}_loop"


def _valve(pieces: Pieces) -> str:
    """The valve as its laws change it."""
    valve, told = pieces.valve, "/* The valve with its laws, N. */\n"
    springs = [p for p in pieces.motion if p.kind == "series_compliance"] if pieces.inner else []
    loop = _loop(pieces)
    given = ("loop",) if loop else ()
    arguments = (
        "const parameters *p, "
        + (f"const {loop} *loop, " if loop else "")
        + "const motion *m, const at_valve_past *past, at_valve_past *next"
    )
    text = told + head("valve_with_laws", arguments) + "\n{\n"
    laws = "".join(f"    {p.kind}({arguments_of(p, 'm')}, &c);\n" for p in pieces.laws)
    idle = "" if valve.memory == "past" else unused("past", "next")
    if pieces.inner:
        inside = "".join(
            f"    c.leakage += {p.kind}({arguments_of(p, 'm')});\n" for p in pieces.leaks
        )
        inside += "".join(f"    c.compliance += p->{p.member}.s_k;\n" for p in springs)
        call = f"{valve.kind}_parts({arguments_of(valve, 'm', '&c')})"
        return (
            f"{text}    changes c = NO_CHANGES;\n    parts both;\n{laws}{inside}"
            f"    both = {call};\n    return both.yielding + both.viscous;\n}}\n\n"
        )
    if not laws and loop:
        call = f"{valve.kind}_force({arguments_of(valve, *given, 'm')})"
        return f"{text}{idle}    return {call};\n}}\n\n"
    call = f"{valve.kind}_parts({arguments_of(valve, *given, '&at')})"
    two = any(p.kind == "width_law_yield" for p in pieces.laws) and loop
    viscous = (
        f"    yielding = both.yielding;\n    at.side = m->side * c.side_viscous;\n"
        f"    both = {call};\n    both.yielding = yielding;\n"
        if two
        else ""
    )
    declared = "    parts both;\n" + ("    double yielding;\n" if two else "")
    return (
        f"{text}    changes c = NO_CHANGES;\n    motion at = *m;\n{declared}{idle}{laws}"
        f"    at.side = m->side * c.side_yielding;\n    both = {call};\n{viscous}"
        "    return c.yielding * both.yielding + c.viscous * both.viscous;\n}\n\n"
    )


def _beside_leak(pieces: Pieces) -> str:
    """The valve at the speed w that leaks leave to it: w + k F(w) = v."""
    leaks = "".join(
        f"    search.leakage += {p.kind}({arguments_of(p, 'm')});\n" for p in pieces.leaks
    )
    loop = _loop(pieces)
    row = f"    {loop} loop;\n" if loop else ""
    known = f"    search.loop = {loop}_of(&p->{pieces.valve.member}, m);\n" if loop else ""
    return (
        _valve(pieces)
        + f"""/* What is left of the speed by leaks: w + k F(w) = v. */
typedef struct {{
    const parameters *p;
{row}    motion at;
    double leakage, velocity, force;
    const at_valve_past *past;
    at_valve_past *next;
}} leak_search;

static double excess_speed(double w, void *about)
{{
    leak_search *s = about;
    s->at.v = w;
    s->force = valve_with_laws(s->p, {"&s->loop, " if loop else ""}&s->at, s->past, s->next);
    return w + s->leakage * s->force - s->velocity;
}}

"""
        + head("beside_leaks", CHAIN)
        + f"""
{{
    leak_search search;
    double start = m->v, slope = m->first ? 1.0 : past->slope;
    int found;
    search.p = p;
    search.at = *m;
    search.leakage = 0.0;
    search.velocity = m->v;
    search.past = past;
    search.next = next;
    if (!m->first)
        start = past->left + (m->v - past->ahead) / slope;
{known}{leaks}    next->left = root_of(excess_speed, &search, start, &slope,
                         1.0e-12 * fabs(m->v), &found);
    next->ahead = m->v;
    next->slope = slope;
    *solved = *solved && found;
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
    rows = [*past_rows([piece]), f"{behind}_past behind"]
    carried = piece.kind == "backlash_loose"
    lines = "" if behind == "at_valve" else "memory, "
    inner = "m" if carried else "&moved"
    call = f"{behind}(p, {lines}{inner}, &past->behind, &next->behind, solved)"
    if carried:
        body = f"    double force = {call};\n    return {piece.kind}({_carried(piece)});\n"
    else:
        moved = f"{piece.kind}({arguments_of(piece, 'm')})"
        body = f"    motion moved = {moved};\n    return {call};\n"
    idle = unused("memory") if not lines and piece.memory != "line" else ""
    return f"{past_struct(name, rows)}{head(name, arguments)}\n{{\n{idle}{body}}}\n"


def _carried(piece: Piece) -> str:
    return arguments_of(piece, "force", "m")


def _recorded(pieces: Pieces, behind: str) -> str:
    """From a sample to the recorded force."""
    rows = [*past_rows([*pieces.drive, *pieces.channel]), f"{behind}_past behind"]
    drive = "".join(f"    at.i = {p.kind}({arguments_of(p, '&at')});\n" for p in pieces.drive)
    channel = "".join(
        f"    force = {p.kind}({arguments_of(p, 'force', '&at')});\n" for p in pieces.channel
    )
    lines = "" if behind == "at_valve" else "memory, "
    used = lines or any(p.memory == "line" for p in pieces.channel)
    short = "".join(
        f"    *short_line = *short_line || {place}.too_short;\n" for place in _delay_lines(pieces)
    )
    return (
        past_struct("whole", rows)
        + "/* The recorded force, N. */\n"
        + head(
            "recorded_force",
            "const parameters *p, lines *memory, const motion *m, const whole_past *past, "
            "whole_past *next, int *solved, int *short_line",
        )
        + "\n{\n    motion at = *m;\n    double force;\n"
        + ("" if used else unused("memory"))
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
