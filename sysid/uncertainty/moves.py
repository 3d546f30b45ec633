r"""How walkers of an ensemble move.

Two kinds, mixed at random:

- a jump to a draw of a density that was fitted to the warm-up, wherever the walker is (an
  independence move, `sysid/uncertainty/jump.py`);
- differential evolution: a step along the difference of two other walkers, which needs no density
  and reaches what the first misses (skewed ends at bounds, directions that only the prior holds).

emcee's snooker move is not among them: in 3.1.6 its step grows with the distance from the walker it
aims at while its weight does not account for that, and a unit normal in five dimensions comes out
with a variance of 0.70 (`tests/uncertainty/test_moves.py`).

Source:
    Tierney, Annals of Statistics 22 (1994): independence chains.  Ter Braak, Statistics and
    Computing 16 (2006), Nelson, Ford and Payne, ApJS 210:11 (2014): differential evolution.
"""

from collections.abc import Sequence
from typing import Any, Final

from emcee.moves import DEMove, MHMove

from sysid.uncertainty.jump import Jump

JUMPS: Final = 0.6
"""Share of independence moves."""
SWAPS: Final = 0.05
"""Share of steps by the whole difference, which lead from one mode to another."""


def moves(jump: Jump | None) -> Sequence[tuple[Any, float]]:
    """Moves and their shares, as emcee takes them; without jumps if there is no density yet."""
    jumps = 0.0 if jump is None else JUMPS
    listed: list[tuple[Any, float]] = [(DEMove(), 1.0 - jumps - SWAPS), (DEMove(gamma0=1.0), SWAPS)]
    if jump is not None:
        listed.append((MHMove(jump.propose), jumps))
    return listed
