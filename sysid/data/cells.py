"""A cell that is no number: what it may be, and what to do about it."""

import datetime
import re
from typing import Final

_CLOCK: Final = re.compile(r"\d\s*:\s*\d")
_DATE: Final = re.compile(
    r"^\s*\d{1,4}\s*[-/.]\s*(\d{1,2}|[^\W\d_]{3,9})\.?(\s*[-/.]?\s*\d{2,4})?\s*$"
)
"""``12.05.2024``, ``2024-05-12``, and what spreadsheets make of 12.05: ``12. May``, ``12-May``."""
_GROUPED: Final = re.compile(r"^\s*[-+−]?\d{1,3}(?:[.,'’\s]\d{3})+(?:[.,]\d*)?\s*$")
_FORMULA: Final = re.compile(r"^\s*#")


def cell_advice(role: str, cell: object) -> str:
    """What to do about a cell of a measured column that is no number.

    Args:
        role: The column's quantity.
        cell: As the reader found it.
    """
    text = str(cell)
    moment = (datetime.date, datetime.time, datetime.timedelta)
    if role == "time" and (isinstance(cell, moment) or _CLOCK.search(text) or _DATE.match(text)):
        return (
            "Clock times and dates are not read: export time in seconds from the start of the test"
        )
    if isinstance(cell, moment) or (_DATE.match(text) and not _GROUPED.match(text)):
        return (
            "It is a date: a spreadsheet has taken a number for one. Export the test again from "
            "the measuring program; what is lost cannot be told from the date"
        )
    if _GROUPED.match(text):
        return "Export the numbers without separators of thousands"
    if _FORMULA.match(text):
        return "A formula failed there: correct it and export again, or remove the row"
    return "Correct the cell, or remove the row"
