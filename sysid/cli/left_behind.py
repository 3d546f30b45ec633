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


def left_behind(output: Path, written: Collection[str]) -> tuple[str, ...]:
    """Names of results that lie in a folder and are not of the run that has just written there.

    They are left alone: draws of an hour may be among them.

    Args:
        output: The folder.
        written: Names of what was written.
    """
    found = (path.name for path in output.iterdir() if path.is_file())
    return tuple(
        sorted(
            name
            for name in found
            if name not in written and (name in OTHERS or NUMBERED.fullmatch(name))
        )
    )


def told_of_earlier(output: Path, written: Collection[str]) -> tuple[str, ...]:
    """The same in a sentence; empty where there are none.

    Args:
        output: The folder.
        written: Names of what was written.
    """
    names = left_behind(output, written)
    if not names:
        return ()
    verb = "is" if len(names) == 1 else "are"
    return (f"{', '.join(names)} in {output} {verb} of an earlier run, not of this one",)
