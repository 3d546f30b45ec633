"""Campaigns of one test, spoiled: each builder writes one into a folder."""

import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.io import savemat
from written_files import csv_text, measured, write

Build = Callable[[Path], object]


def text(old: str = "", new: str = "", **columns: np.ndarray) -> Build:
    """`a.csv` with one piece of its text replaced."""

    def build(folder: Path) -> None:
        content = csv_text({**measured(), **columns})
        assert old in content
        write(folder, "a.csv", content.replace(old, new, 1))

    return build


def raw(content: bytes | str) -> Build:
    return lambda folder: write(folder, "a.csv", content)


def line(number: int, content: str) -> Build:
    """`a.csv` with one line (from 1) replaced."""

    def build(folder: Path) -> None:
        lines = csv_text(measured()).split("\n")
        lines[number - 1] = content
        write(folder, "a.csv", "\n".join(lines))

    return build


def other(name: str, content: bytes | str, extra: str = "") -> Build:
    """A file of another format, with a manifest that asks for it."""

    def build(folder: Path) -> None:
        write(folder, name, content)
        write(folder, "campaign.toml", f'[files]\nglob = "a.*"\n{extra}')

    return build


def beside(name: str, content: bytes | str) -> Build:
    """A sound `a.csv` with a bad file beside it."""

    def build(folder: Path) -> None:
        write(folder, "a.csv", csv_text(measured()))
        write(folder, name, content)

    return build


def half(content: bytes) -> bytes:
    return content[: len(content) // 2]


def without(name: str) -> dict[str, np.ndarray]:
    return {key: values for key, values in measured().items() if key != name}


def with_nan() -> dict[str, np.ndarray]:
    columns = measured()
    columns["force_N"][6] = np.nan
    return columns


def ragged() -> dict[str, np.ndarray]:
    columns = measured()
    columns["force_N"] = columns["force_N"][:-3]
    return columns


def flipped(content: bytes, at: int, value: int) -> bytes:
    return content[:at] + bytes([value]) + content[at + 1 :]


def mat4_bytes(columns: dict[str, np.ndarray]) -> bytes:
    out = io.BytesIO()
    savemat(out, columns, format="4")
    return out.getvalue()
