"""The same three tests of one damper, as strangers write them, and what is to be read.

The truth is asymmetric in force and current, so that a wrong sign, unit or column cannot pass.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from written_files import csv_text, write

from sysid.data.campaign import Campaign, load_campaign
from sysid.errors import SysidError

CURRENTS = (0.0, 0.25, 0.5)
ROWS = 400
TIME = np.arange(ROWS) / 200.0
DISPLACEMENT = 12.5e-3 * np.sin(2.0 * np.pi * 2.0 * TIME)
"""m, compression positive."""


def force(current: float) -> np.ndarray:
    """N: more in compression than in rebound."""
    velocity = np.cos(2.0 * np.pi * 2.0 * TIME)
    plain = (200.0 + 1500.0 * current) * np.tanh(6.0 * velocity) + 150.0 * velocity
    return np.where(plain > 0.0, 1.3, 1.0) * plain


Columns = Mapping[str, np.ndarray]
Spelling = Callable[[float], dict[str, np.ndarray]]


def names(time: str, displacement: str, force_name: str, current: str | None = None) -> Spelling:
    """Columns in SI-like units as a header says: ms, mm, kN, mA are understood by their text."""

    def scale(header: str, unit: str, factor: float) -> float:
        return factor if re.search(rf"\b{unit}\b|_{unit}$", header) else 1.0

    def columns(ampere: float) -> dict[str, np.ndarray]:
        out = {
            time: TIME * scale(time, "ms", 1e3),
            displacement: DISPLACEMENT * scale(displacement, "mm", 1e3),
            force_name: force(ampere) * scale(force_name, "kN", 1e-3),
        }
        if current is not None:
            out[current] = np.full(ROWS, ampere) * scale(current, "mA", 1e3)
        return out

    return columns


USUAL = names("time_s", "displacement_mm", "force_N", "current_A")


def write_all(
    folder: Path,
    spelling: Spelling,
    text: Callable[[Columns], str | bytes] = csv_text,
    name: Callable[[float], str] = lambda ampere: f"12.5mm_2Hz_{ampere}A.csv",
) -> None:
    for ampere in CURRENTS:
        write(folder, name(ampere), text(spelling(ampere)))


def assert_right(campaign: Campaign) -> None:
    assert len(campaign.records) == len(CURRENTS)
    by_current = sorted(campaign.records, key=lambda record: record.nominal.current or 0.0)
    for record, ampere in zip(by_current, CURRENTS, strict=True):
        np.testing.assert_allclose(record.time, TIME, atol=1e-9)
        np.testing.assert_allclose(record.displacement, DISPLACEMENT, atol=1e-9)
        np.testing.assert_allclose(record.force, force(ampere), atol=1e-6)
        assert record.nominal.current == pytest.approx(ampere)


def germans(columns: Columns) -> str:
    return csv_text(columns, ";", ",")


@dataclass(frozen=True)
class Message:
    """A refusal, all of whose parts are there."""

    what: str
    where: str
    advice: str


def refused(folder: Path) -> Message:
    with pytest.raises(SysidError) as caught:
        load_campaign(folder)
    error = caught.value
    assert error.where is not None
    assert error.advice is not None
    assert str(folder) in error.where
    return Message(error.what, error.where, error.advice)


def replace_in_all(folder: Path, change: Callable[[str], str]) -> None:
    for path in folder.glob("*.csv"):
        path.write_text(change(path.read_text(encoding="utf-8")), encoding="utf-8")


def manifest(folder: Path, text: str) -> None:
    (folder / "campaign.toml").write_text(text, encoding="utf-8")


NO_CURRENT = names("time_s", "displacement_mm", "force_N")


def pasted(folder: Path, advice: str) -> None:
    """The lines of an advice, into the file that it names."""
    found = re.search(r"[wW]rite into (\S+):\n(.*)", advice, re.DOTALL)
    assert found, advice
    assert "…" not in found[2], "nothing is left to fill in"
    (folder / Path(found[1]).name).write_text(found[2] + "\n", encoding="utf-8")
    if "/" in found[1]:
        assert Path(found[1]) == folder / "campaign.toml"
