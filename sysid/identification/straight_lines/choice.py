"""Which tests each recipe takes: the paper's own where they exist, otherwise by a rule."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from sysid.identification.straight_lines.levels import Excitation

FAST: Final = (0.010, 8.0)
SLOW: Final = (0.005, 4.0)
"""m, Hz: the paper's excitations for C_post and k, and for F_y."""
HIGH_CURRENTS: Final = (0.8, 1.0, 2.0)
PRINTED_CURRENT: Final = 1.0
"""A, of the paper's k: those that it shows, and the one whose line it prints."""


@dataclass(frozen=True)
class Chosen:
    """An excitation, or none, and why.

    Attributes:
        excitation: None where the campaign holds nothing suitable.
        rule: In words.
    """

    excitation: Excitation | None
    rule: str


def fast_excitation(groups: Sequence[Excitation], wanted: tuple[float, float] | None) -> Chosen:
    """The excitation of C_post and k: as asked, the paper's, or the fastest.

    Fast tests have the most data after yield.  One that was made at less than half as many
    conditions as the commonest excitation is passed over.

    Args:
        groups: Of the campaign, at least one, slowest first.
        wanted: m, Hz; None: as the rule says.
    """
    told = _told(groups, wanted, FAST)
    if told is not None:
        return told
    most = max(len(g.tests) for g in groups)
    fastest = [g for g in groups if 2 * len(g.tests) >= most][-1]
    return Chosen(
        fastest,
        f"{fastest}, the fastest excitation (the paper's {_named(FAST)} is not in the campaign)",
    )


def slow_excitation(
    groups: Sequence[Excitation], fast: Excitation | None, wanted: tuple[float, float] | None
) -> Chosen:
    """The excitation of F_y: as asked, the paper's, or one about four times slower than the fast.

    Yield force is a parameter at zero velocity.  Slower still would leave little after yield, so
    the paper's ratio of peak velocities, a quarter, is kept as nearly as the tests allow.

    Args:
        groups: Of the campaign, at least one, slowest first.
        fast: That of C_post; where there is none, the fastest counts.
        wanted: m, Hz; None: as the rule says.
    """
    told = _told(groups, wanted, SLOW)
    if told is not None:
        return told
    fast = fast or groups[-1]
    slower = [g for g in groups if g.peak_velocity <= 0.5 * fast.peak_velocity]
    if not slower:
        return Chosen(
            None, f"no test is slower than half the peak velocity of {fast}, as F_y needs"
        )
    most = max(len(g.tests) for g in slower)
    common = [g for g in slower if 2 * len(g.tests) >= most]
    nearest = min(common, key=lambda g: abs(np.log(4.0 * g.peak_velocity / fast.peak_velocity)))
    return Chosen(
        nearest,
        f"{nearest}, whose peak velocity is nearest to a quarter of the fast tests' (the paper's "
        f"{_named(SLOW)} is not in the campaign)",
    )


def high_levels(levels: Sequence[float]) -> tuple[float, ...]:
    """The currents for k.

    The paper's where the campaign has its 1 A, otherwise those from 0.8 of the largest on.
    """
    near = [z for z in levels if min(abs(z - c) for c in HIGH_CURRENTS) < 0.05 * max(z, 0.5)]
    if any(abs(z - PRINTED_CURRENT) < 0.05 for z in near):
        return tuple(near)
    return tuple(z for z in levels if z > 0.0 and z >= 0.8 * max(levels))


def printed_level(levels: Sequence[float]) -> float:
    """The current whose line is printed: 1 A, or the largest."""
    nearest = min(levels, key=lambda z: abs(z - PRINTED_CURRENT))
    return nearest if abs(nearest - PRINTED_CURRENT) < 0.05 else max(levels)


def _told(
    groups: Sequence[Excitation], wanted: tuple[float, float] | None, paper: tuple[float, float]
) -> Chosen | None:
    found = [g for g in groups if g.is_near(*(wanted or paper))]
    if found:
        word = "as asked" if wanted else "the paper's"
        return Chosen(found[-1], f"{found[-1]}, {word}")
    return None if wanted is None else Chosen(None, f"no test has {_named(wanted)}, as asked")


def _named(excitation: tuple[float, float]) -> str:
    return f"{1e3 * excitation[0]:.3g} mm at {excitation[1]:.3g} Hz"
