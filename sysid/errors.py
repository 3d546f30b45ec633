"""The one family of errors that a user can cause.

Every error says what is wrong, where (file, line, column, test) and what to do about it.  The
command line turns any of them into one message and exit code 1; a traceback is a defect of
`sysid`.  Not converging is no error: it is a result code of the fit.
"""

from pathlib import Path


class SysidError(Exception):
    """Something in the user's input is at fault.

    Args:
        what: What is wrong, one sentence without a full stop.
        where: Where it is: a file, and if known line, column or test.
        advice: What to do about it, one sentence.
    """

    what: str
    where: str | None
    advice: str | None

    def __init__(
        self, what: str, *, where: str | Path | None = None, advice: str | None = None
    ) -> None:
        self.what = what
        self.where = None if where is None else str(where)
        self.advice = advice
        super().__init__(str(self))

    def __str__(self) -> str:
        text = self.what if self.where is None else f"{self.where}: {self.what}"
        return text if self.advice is None else f"{text}. {self.advice}"


class DataError(SysidError):
    """A data file cannot be read as what it claims to be."""


class ManifestError(SysidError):
    """`campaign.toml` or `tests.csv` is malformed, or contradicts the files."""


class UnitError(SysidError):
    """A unit is not known, or belongs to another quantity."""


class CardError(SysidError):
    """A model card is malformed, too new, or fails its own check vectors."""


class FitError(SysidError):
    """The campaign cannot be fitted as asked (nothing left to fit, no current, …)."""


class OutputError(SysidError):
    """A result cannot be written where the user wants it."""


class ClusterError(SysidError):
    """Workers on other machines, or their scheduler, cannot be used."""


class Stopped(Exception):  # noqa: N818  # the user's will, no error
    """The user stopped long work; the message says what is kept and how to go on."""
