"""Which program a result belongs to: a fingerprint of what its source says, not of how it looks."""

import ast
import hashlib
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Final

import sysid

SOURCE: Final = Path(sysid.__file__).parent
TRIALS: Final = (
    "arrays.py", "data", "diagnosis", "effects", "identification", "likelihood", "models", "motion",
    "parameters.py", "rig", "trials/misfit.py", "trials/outcome.py", "trials/quantities.py",
    "trials/regimes.py", "trials/score.py", "trials/visible.py", "uncertainty/directions.py",
    "units.py",
)  # fmt: skip
"""What of the package a trial depends on, but for the physical damper."""
PHYSICAL: Final = ("rig/physical",)
"""What only trials of the physical damper depend on besides, with `OWN`."""
OWN: Final = ("trials/physical.py",)


@lru_cache(maxsize=2)
def program(physical: bool) -> str:
    """Fingerprint of what makes, diagnoses and scores a trial.

    Args:
        physical: Of the physical damper.
    """
    return fingerprint((*TRIALS, *OWN)) if physical else fingerprint(TRIALS, PHYSICAL)


def fingerprint(parts: Sequence[str], but: Sequence[str] = ()) -> str:
    """Twelve hex digits that change with the code of some modules and packages.

    Comments, docstrings and layout do not count: a study may go on after they were mended.

    Args:
        parts: Names inside the package, such as ``diagnosis`` or ``units.py``.
        but: Names of what does not count in these.

    Raises:
        FileNotFoundError: There is no such part.
    """
    digest = hashlib.sha256()
    for part in sorted(parts):
        place = SOURCE / part
        for file in sorted(place.rglob("*.py")) if place.is_dir() else [place]:
            if any(file.is_relative_to(SOURCE / name) for name in but):
                continue
            digest.update(f"{file.relative_to(SOURCE).as_posix()}\n".encode())
            digest.update(meaning(file.read_text("utf-8")).encode())
    return digest.hexdigest()[:12]


def meaning(source: str) -> str:
    """What a module says: its code without comments, docstrings and layout."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [s for s in body if not _is_text(s)]  # type: ignore[attr-defined]  # any node
    return ast.unparse(tree)


def _is_text(statement: ast.stmt) -> bool:
    return (
        isinstance(statement, ast.Expr)
        and isinstance(statement.value, ast.Constant)
        and isinstance(statement.value.value, str)
    )
