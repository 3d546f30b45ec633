"""One reader a file format; the registry says which file goes where."""

from pathlib import Path
from typing import Final

from sysid.data.columns import Naming
from sysid.data.readers.base import RawTable, Reader
from sysid.data.readers.mat import MAT
from sysid.data.readers.parquet import PARQUET
from sysid.data.readers.tdms import TDMS
from sysid.data.readers.text import TEXT
from sysid.data.readers.xlsx import XLSX
from sysid.errors import DataError

READERS: Final[tuple[Reader, ...]] = (TEXT, MAT, XLSX, TDMS, PARQUET)


def find_reader(path: Path) -> Reader | None:
    """The reader for a file, by its ending; None where there is none."""
    suffix = path.suffix.lower()
    return next((reader for reader in READERS if suffix in reader.suffixes), None)


def read_tables(
    data: bytes, path: Path, naming: Naming, encoding: str | None = None
) -> tuple[RawTable, ...]:
    """Read the tables of one file.

    Args:
        data: The whole file.
        path: Its name decides the format; it is not opened.
        naming: How columns are named.
        encoding: Of text, from the manifest; None: recognised.

    Raises:
        DataError: The format is not known, or the file is not what it claims to be.
    """
    reader = find_reader(path)
    if reader is None:
        known = ", ".join(suffix for r in READERS for suffix in r.suffixes)
        raise DataError(
            f"files of kind {path.suffix or '(no ending)'!r} cannot be read",
            where=path,
            advice=f"Export the measurement as one of: {known}",
        )
    return reader.read(data, path, naming, encoding)
