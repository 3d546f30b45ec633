"""The plan and the thresholds are on disk before the first answer, and do not change afterwards."""

import hashlib
import json
from pathlib import Path
from typing import Any, Final

from sysid.data.whole_file import write_text
from sysid.errors import DataError, OutputError
from sysid.jobs.rows import read_rows
from sysid.trials.plan import Plan
from sysid.trials.program import program
from sysid.trials.score import RIGHT
from sysid.trials.summary import SURE
from sysid.trials.trial_id import PHYSICAL
from sysid.trials.visible import DETECTED, NAMED

FILE: Final = "plan.json"
ROWS: Final = "trials.jsonl"
"""What the trials of a sealed plan leave, one a line."""
SCHEMA: Final = "sysid-trials-plan-1"
THRESHOLDS: Final[dict[str, Any]] = {
    "right": list(RIGHT), "sure": SURE, "detectable_distance": DETECTED, "visible_right": NAMED,
    "interval": 0.95,
}  # fmt: skip
"""By which answers are judged: verdicts that count as right, the confidence from which nine in ten
names must be right, the bound from which an effect counts as visible, level of all intervals."""


def seal(plan: Plan, folder: Path) -> str:
    """Write plan, program and thresholds, or find the same there.

    Args:
        plan: Of the study.
        folder: Of its results.

    Returns:
        SHA-256 of what was sealed, hexadecimal.

    Raises:
        OutputError: The folder holds results of another plan or another program, or of no sealed
            plan.
        DataError: What is sealed there cannot be read or was changed.
    """
    inside = {
        "plan": [group.model_dump(exclude_none=True) for group in plan.groups],
        "program": programs(plan),
        "thresholds": THRESHOLDS,
    }
    inside = json.loads(json.dumps(inside))
    path = folder / FILE
    if path.exists():
        before = _open(path)
        for what in inside:
            if before.get(what) != inside[what]:
                raise OutputError(
                    f"holds trials of another {what.removesuffix('s')}"
                    + (f" ({before.get(what)}, not {inside[what]})" if what == "program" else ""),
                    where=folder,
                    advice="Give another folder (-o); plan and thresholds are fixed before the "
                    "first answer",
                )
        return _hash(inside)
    if read_rows(folder / ROWS):
        raise OutputError(
            f"holds trials but no sealed plan ({FILE})",
            where=folder,
            advice="Put the plan back that they were run by, or give another folder (-o); "
            f"sysid trials --rows {folder / ROWS} makes a page of them",
        )
    folder.mkdir(parents=True, exist_ok=True)
    sealed = {"schema": SCHEMA, "sha256": _hash(inside), **inside}
    write_text(path, json.dumps(sealed, indent=1, ensure_ascii=False) + "\n")
    return _hash(inside)


def programs(plan: Plan) -> str:
    """Fingerprint of what the trials of a plan depend on, physical ones apart."""
    kinds = sorted({group.regime == PHYSICAL for group in plan.groups})
    return " + ".join(program(kind) for kind in kinds)


def _open(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text("utf-8"))
        schema, digest = content.pop("schema"), content.pop("sha256")
    except (OSError, ValueError, KeyError, AttributeError) as cause:
        raise DataError("is no sealed plan", where=path, advice="Give another folder") from cause
    if schema != SCHEMA or digest != _hash(content):
        raise DataError("was changed after it was sealed", where=path, advice="Give another folder")
    return content


def _hash(content: dict[str, Any]) -> str:
    text = json.dumps(content, sort_keys=True, ensure_ascii=True)
    return hashlib.sha256(text.encode("ascii")).hexdigest()
