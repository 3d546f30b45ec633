"""How curves look, on the first screen and wherever the script draws: one list for both."""

from dataclasses import dataclass
from typing import Any, Final


@dataclass(frozen=True)
class Look:
    """Of a curve.

    Attributes:
        colour: One that colour-blind readers tell from the others (Okabe and Ito).
        dash: Plotly's name of it.
        width: Pixels.
    """

    colour: str
    dash: str
    width: float

    @property
    def dashes(self) -> str:
        """The same dash as lengths of an SVG line; "none" for a solid one."""
        return _DASHES[self.dash]

    def json(self) -> dict[str, Any]:
        """For the page's script."""
        return {"color": self.colour, "dash": self.dash, "width": self.width}


_DASHES: Final = {
    "solid": "none", "dash": "8 5", "dot": "2 4", "dashdot": "8 4 2 4", "longdash": "13 6",
}  # fmt: skip

MEASURED: Final = Look("#9aa3ad", "solid", 5.0)
BEFORE: Final = Look("#d55e00", "dash", 1.6)
AFTER: Final = Look("#0072b2", "solid", 1.8)
FURTHER: Final = (
    Look("#009e73", "dot", 1.8), Look("#cc79a7", "dashdot", 1.8), Look("#000000", "longdash", 1.4),
    Look("#e69f00", "solid", 1.6), Look("#56b4e9", "dash", 1.6),
)  # fmt: skip


def looks(models: int) -> tuple[Look, ...]:
    """Of the curves of some models, the measured one not among them.

    Args:
        models: Their number.  The last one looks as an extended model does.
    """
    others = (BEFORE, *FURTHER)
    return (*(others[k % len(others)] for k in range(models - 1)), AFTER)
