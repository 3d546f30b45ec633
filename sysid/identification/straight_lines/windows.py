"""Which part of a loop each straight line is laid through: chosen once, and varied."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Final


@dataclass(frozen=True)
class Window:
    """Points between two shares of a way, both ends left out.

    Attributes:
        low: Share at which the points begin.
        high: Share at which they end.
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.low < self.high <= 1.0:
            raise ValueError(f"a window needs 0 ≤ low < high ≤ 1, not {self.low}, {self.high}")

    def __str__(self) -> str:
        return f"{100 * self.low:.3g} to {100 * self.high:.3g} %"


def window_grid(lows: Sequence[float], highs: Sequence[float]) -> tuple[Window, ...]:
    """All windows between some beginnings and some ends."""
    return tuple(Window(low, high) for low, high in product(lows, highs))


POST_GRID: Final = window_grid((0.1, 0.2, 0.3, 0.4, 0.5), (0.7, 0.8, 0.9))
YIELD_GRID: Final = window_grid((0.2, 0.3, 0.4, 0.5), (0.7, 0.8, 0.9))
STIFFNESS_GRID: Final = window_grid((0.05, 0.1, 0.15, 0.2), (0.5, 0.6, 0.7, 0.8))
"""Windows that somebody else might have chosen."""


@dataclass(frozen=True)
class Windows:
    """The choice of points of all three stages.

    The paper does not state its windows; the defaults are this reading of it.

    Attributes:
        post: C_post, in parts of peak speed, on the decelerating branch.
        yielding: F_y, likewise.
        stiffness: k, in parts of the way of the force from the reversal to −F_y.
        post_grid: Other choices for C_post; how far the value moves over them is its sensitivity.
        yield_grid: Likewise for F_y.
        stiffness_grid: Likewise for k.
    """

    post: Window = Window(0.1, 0.9)
    yielding: Window = Window(0.3, 0.9)
    stiffness: Window = Window(0.1, 0.6)
    post_grid: tuple[Window, ...] = POST_GRID
    yield_grid: tuple[Window, ...] = YIELD_GRID
    stiffness_grid: tuple[Window, ...] = STIFFNESS_GRID
