"""Parquet by pyarrow; a file is one table."""

from pathlib import Path
from typing import Any, Final

import numpy as np

from sysid.data.columns import Naming
from sysid.data.readers.base import RawTable, Reader, as_cells, guarded
from sysid.data.readers.grid import no_header
from sysid.data.readers.tree import Tree, table_from_columns
from sysid.errors import DataError


def read_parquet(
    data: bytes, path: Path, naming: Naming, encoding: str | None = None
) -> tuple[RawTable, ...]:
    """Read a Parquet file.

    Raises:
        DataError: The file is damaged, or has no columns for a test.
    """
    del encoding
    if not data:
        raise DataError("is empty", where=path, advice="Export the file again, or remove it")
    with guarded(path, "Parquet"):
        import pyarrow
        from pyarrow import parquet

        table = parquet.read_table(
            pyarrow.BufferReader(data), use_threads=False, page_checksum_verification=True
        )
        table.validate(full=True)
        wanted = [name for name in table.column_names if naming.recognised([name])]
        if len(set(table.column_names)) != len(table.column_names):
            raise DataError("has two columns of one name", where=path, advice="Rename one of them")
        fields: dict[str, Tree] = {name: _values(table.column(name)) for name in wanted}
        unread = {name: "" for name in table.column_names if name not in wanted}
    if not fields:
        raise no_header(path, list(unread), has=bool(naming.named))
    return (table_from_columns({**fields, **unread}, naming, path, None, {}),)


def _values(column: Any) -> np.ndarray:
    """A column as numbers, NaN where empty; as objects where it holds something else."""
    import pyarrow.types as types

    kind = column.type
    if types.is_floating(kind) or types.is_integer(kind) or types.is_decimal(kind):
        return np.asarray(column.cast("float64").to_numpy(), dtype=np.float64)
    cells = as_cells(column.to_pylist())
    if cells.dtype.kind == "f":
        return np.asarray(cells, dtype=np.float64)
    return np.asarray(cells, dtype=object)


PARQUET: Final = Reader("Parquet", (".parquet", ".pq"), read_parquet)
