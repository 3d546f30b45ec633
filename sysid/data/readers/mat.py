"""MATLAB files: v5 (up to R2006 and by default since), and v7.3 (HDF5) by h5py."""

import io
from pathlib import Path
from typing import Any, Final

import numpy as np

from sysid.data.columns import Naming
from sysid.data.readers.base import RawTable, Reader, guarded
from sysid.data.readers.mat5 import read_mat5
from sysid.data.readers.tree import Tree, tables_from_tree
from sysid.errors import DataError

_HDF5_MARK: Final = b"\x89HDF\r\n\x1a\n"
_DEEPEST: Final = 8


def read_mat(
    data: bytes, path: Path, naming: Naming, encoding: str | None = None
) -> tuple[RawTable, ...]:
    """Read a ``.mat`` file: variables, a struct with fields, or struct arrays (many tests).

    Raises:
        DataError: The file is damaged, or holds no tables that can be read.
    """
    del encoding
    if not data:
        raise DataError("is empty", where=path, advice="Export the file again, or remove it")
    with guarded(path, "MATLAB"):
        new = _HDF5_MARK in (data[:8], data[512:520])
        tree = _tree_v73(data) if new else read_mat5(data)
    return tables_from_tree(tree, naming, path, "MATLAB")


def _tree_v73(data: bytes) -> dict[str, Tree]:
    import h5py

    with h5py.File(io.BytesIO(data), "r") as file:
        return {
            str(name): _from_hdf5(file[name], file, 0)
            for name in file
            if not str(name).startswith("#")
        }  # fmt: skip


def _from_hdf5(node: Any, file: Any, depth: int) -> Tree:
    """Groups and datasets of h5py as dict, list, text or numbers (MATLAB stores transposed)."""
    import h5py

    if depth > _DEEPEST:
        return None
    if isinstance(node, h5py.Group):
        fields = {str(name): _from_hdf5(node[name], file, depth + 1) for name in node}
        return _struct_array(fields) or fields
    if not isinstance(node, h5py.Dataset):
        return None
    if node.attrs.get("MATLAB_empty", 0):
        return np.empty(0)
    if node.dtype == h5py.ref_dtype:
        return [_from_hdf5(file[ref], file, depth + 1) for ref in np.ravel(node[()])]
    if node.attrs.get("MATLAB_class", b"") == b"char":
        return "".join(chr(code) for code in np.ravel(node[()]))
    values = np.asarray(node[()])
    return values.T if values.dtype.kind in "fiucb" else None


def _struct_array(fields: dict[str, Tree]) -> list[Tree] | None:
    """A struct array is stored as a struct of lists, all of one length."""
    lists = [value for value in fields.values() if isinstance(value, list)]
    if not fields or len(lists) != len(fields) or len({len(value) for value in lists}) != 1:
        return None
    return [dict(zip(fields, row, strict=True)) for row in zip(*lists, strict=True)]


MAT: Final = Reader("MATLAB", (".mat",), read_mat)
