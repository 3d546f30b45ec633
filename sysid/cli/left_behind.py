"""What an earlier run left in a folder of results, and this one did not write again."""

import re
from collections.abc import Collection
from pathlib import Path
from typing import Final

NUMBERED: Final = re.compile(
    r"(card|fit|posterior|report|worst|loops|corner|trace|profiles|bands|straight_lines)"
    r"(-\d+)?\.(json|h5|html|png)"
)
"""Files of a fit, of one card or of several."""
OTHERS: Final = frozenset(
    {"diagnosis.json", "open.json", "before_after.png", "gain.png", "screen.png",
     "lack_of_fit.png"}
)  # fmt: skip
"""Files of a diagnosis."""


def left_behind(
    output: Path, written: Collection[str], own: Collection[str] | None = None
) -> tuple[str, ...]:
    """Names of results that lie in a folder and are not of the run that has just written there.

    They are left alone: draws of an hour may be among them.

    Args:
        output: The folder.
        written: Names of what was written.
        own: All names that the command writes; None for a fit or a diagnosis, which may stand in
            one folder.
    """
    found = (path.name for path in output.iterdir() if path.is_file())
    return tuple(sorted(name for name in found if name not in written and _known(name, own)))


def _known(name: str, own: Collection[str] | None) -> bool:
    if own is not None:
        return name in own
    return name in OTHERS or NUMBERED.fullmatch(name) is not None


def told_of_earlier(
    output: Path, written: Collection[str], own: Collection[str] | None = None
) -> tuple[str, ...]:
    """The same in a sentence; empty where there are none.

    Args:
        output: The folder.
        written: Names of what was written.
        own: As for `left_behind`.
    """
    names = left_behind(output, written, own)
    if not names:
        return ()
    verb = "is" if len(names) == 1 else "are"
    return (f"{', '.join(names)} in {output} {verb} of an earlier run, not of this one",)
