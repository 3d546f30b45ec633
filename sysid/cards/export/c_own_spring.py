"""A spring in series with a valve that takes it into its own equations, as C99."""

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
from sysid.cards.export.sources import source


def behind_own_spring(pieces: Pieces, own: Piece) -> str:
    """Valve, leaks and forces in parallel behind a spring that the valve takes as its own.

    Of the forces in parallel, P, the valve feels no more than that the spring gives by s P.  So P
    is found first, beside the force of the valve alone, and then the valve anew.
    """
    leaks = "".join(
        f"    c.leakage += {p.kind}({arguments_of(p, 'leak_at')});\n" for p in pieces.leaks
    )
    laws = "".join(f"    {p.kind}({arguments_of(p, 'm')}, &c);\n" for p in pieces.laws)
    valve = (
        past_struct("own", past_rows([pieces.valve, *pieces.leaks]))
        + "/* The valve with laws, leaks and spring, N; leaks go by a motion of their own. */\n"
        + head(
            "own_valve",
            "const parameters *p, const motion *m, const motion *leak_at, const own_past *past, "
            "own_past *next",
        )
        + "\n{\n    changes c = NO_CHANGES;\n    parts both;\n    (void)leak_at;\n"
        f"{laws}{leaks}"
        f"    c.compliance = p->{own.member}.s_k;\n"
        f"    both = {pieces.valve.kind}_parts({arguments_of(pieces.valve, 'm', '&c')});\n"
        "    return both.yielding + both.viscous;\n}\n\n"
    )
    forces = "".join(f"    force += {p.kind}({arguments_of(p, 'm')});\n" for p in pieces.forces)
    rows = ["own_past alone, own", "carried of_valve, of_parallel"]
    beside, moved = "", "    motion moved = *m;\n"
    parallel = ""
    if pieces.forces:
        rows.append(f"through_{own.member}_past spring")
        parallel = (
            past_struct("parallel", past_rows(pieces.forces))
            + "/* The forces in parallel, N. */\n"
            + head(
                "parallel",
                "const parameters *p, const motion *m, const parallel_past *past, "
                "parallel_past *next, int *solved",
            )
            + f"\n{{\n    double force = 0.0;\n{unused('past', 'next', 'solved')}{forces}"
            "    return force;\n}\n\n" + spring(own, "parallel") + "\n"
        )
        beside = (
            f"    beside = through_{own.member}(p, NULL, &inner, &past->spring, &next->spring,\n"
            "                                       solved);\n"
            "    moved = behind_spring(s_k, beside, m, &past->of_parallel, &next->of_parallel);\n"
            "    inner.x += next->spring.solution[1].offset;\n"
        )
    return (
        "/* ---- The damper, from the valve outwards ---- */\n\n"
        + source("own_spring.c")
        + "\n"
        + valve
        + parallel
        + past_struct("at_valve", rows)
        + "/* Valve and the forces in parallel, N. */\n"
        + head("at_valve", CHAIN)
        + f"\n{{\n    double s_k = p->{own.member}.s_k, beside = 0.0;\n"
        "    double alone = own_valve(p, m, m, &past->alone, &next->alone);\n"
        "    motion inner = behind_spring(s_k, alone, m, &past->of_valve, &next->of_valve);\n"
        f"{moved}    (void)solved;\n{beside}"
        "    return own_valve(p, &moved, &inner, &past->own, &next->own) + beside;\n}\n"
    )
