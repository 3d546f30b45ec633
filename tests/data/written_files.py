"""One measured test written in every format, for the tests of the readers."""

import io
from collections.abc import Callable, Mapping
from pathlib import Path

import h5py
import numpy as np
import openpyxl
import pyarrow as pa
import pyarrow.parquet as pq
from nptdms import ChannelObject, RootObject, TdmsWriter
from scipy.io import savemat

RATE = 100.0


def measured(rows: int = 60, current: float = 0.5) -> dict[str, np.ndarray]:
    t = np.arange(rows) / RATE
    v = np.cos(2 * np.pi * 2 * t)
    return {
        "time_s": t,
        "displacement_mm": 5.0 * np.sin(2 * np.pi * 2 * t),
        "force_N": 400.0 * np.tanh(4 * v) + 800.0 * current * v,
    }


def csv_text(columns: Mapping[str, np.ndarray], separator: str = ",", decimal: str = ".") -> str:
    lines = [separator.join(columns)]
    for row in zip(*columns.values(), strict=True):
        cells = [c if isinstance(c, str) else repr(float(c)) for c in row]
        lines.append(separator.join(cell.replace(".", decimal) for cell in cells))
    return "\n".join(lines) + "\n"


def csv_bytes(columns: Mapping[str, np.ndarray]) -> bytes:
    return csv_text(columns).encode()


def mat5_bytes(columns: Mapping[str, np.ndarray]) -> bytes:
    out = io.BytesIO()
    savemat(out, {name: values.reshape(-1, 1) for name, values in columns.items()})
    return out.getvalue()


def mat73_bytes(columns: Mapping[str, np.ndarray]) -> bytes:
    out = io.BytesIO()
    with h5py.File(out, "w", userblock_size=512) as file:
        for name, values in columns.items():
            file.create_dataset(name, data=values.reshape(1, -1)).attrs["MATLAB_class"] = np.bytes_(
                "double"
            )
    return b"MATLAB 7.3 MAT-file".ljust(512, b" ") + out.getvalue()[512:]


def xlsx_bytes(columns: Mapping[str, np.ndarray], **sheets: Mapping[str, np.ndarray]) -> bytes:
    book = openpyxl.Workbook()
    book.remove(book.worksheets[0])
    for title, table in {"data": columns, **sheets}.items():
        sheet = book.create_sheet(title)
        sheet.append(list(table))
        for row in zip(*table.values(), strict=True):
            sheet.append([cell if isinstance(cell, str) else float(cell) for cell in row])
    out = io.BytesIO()
    book.save(out)
    return out.getvalue()


def tdms_bytes(columns: Mapping[str, np.ndarray], **groups: Mapping[str, np.ndarray]) -> bytes:
    out = io.BytesIO()
    with TdmsWriter(out) as writer:
        for group, table in {"data": columns, **groups}.items():
            channels = [ChannelObject(group, name, values) for name, values in table.items()]
            writer.write_segment([RootObject(), *channels])
    return out.getvalue()


def parquet_bytes(columns: Mapping[str, np.ndarray]) -> bytes:
    out = io.BytesIO()
    pq.write_table(pa.table(dict(columns)), out, write_page_checksum=True)
    return out.getvalue()


FORMATS: tuple[tuple[str, Callable[[Mapping[str, np.ndarray]], bytes]], ...] = (
    (".csv", csv_bytes),
    (".mat", mat5_bytes),
    ("-v73.mat", mat73_bytes),
    (".xlsx", xlsx_bytes),
    (".tdms", tdms_bytes),
    (".parquet", parquet_bytes),
)


def write(folder: Path, name: str, content: bytes | str) -> Path:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path
