"""MATLAB v5 files element by element, with every length checked before it is followed.

scipy's compiled reader follows the lengths that a file states; on a damaged file (one flipped bit
in an array's flags is enough) it reads past the end of the buffer and ends the whole process.  A
data path must answer with a message instead, so the few array classes that hold measurements are
read here.

Source: MathWorks, "MAT-File Format" (level 5: tags, small elements, array classes).
"""

import math
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from sysid.data.readers.tree import Tree

_MATRIX, _COMPRESSED = 14, 15
_CELL, _STRUCT, _CHAR, _OPAQUE = 1, 2, 4, 17
_NUMERIC: Final = range(6, 16)
_COMPLEX: Final = 0x0800
_STORED: Final[dict[int, str]] = {
    1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8",
}  # fmt: skip
"""Type number of a stored element → numpy type."""

_TEXTS: Final[dict[int, str]] = {1: "latin-1", 2: "latin-1", 4: "utf-16", 16: "utf-8",
                                 17: "utf-16", 18: "utf-32"}  # fmt: skip
_DEEPEST: Final = 8
_LARGEST: Final = 2**31


class Mat5Error(ValueError):
    """The bytes are no sound level-5 file."""


@dataclass
class _Bytes:
    """A buffer with a reading position; never reads past its end."""

    data: bytes
    order: str
    at: int = 0

    def take(self, count: int) -> bytes:
        """The next `count` bytes."""
        if count > len(self.data) - self.at:
            raise Mat5Error(f"{count} bytes are stated, {len(self.data) - self.at} are left")
        piece = self.data[self.at : self.at + count]
        self.at += count
        return piece

    def element(self) -> tuple[int, bytes]:
        """The next element: its type and content."""
        first = self._whole()
        if first >> 16:
            count = first >> 16
            if count > 4:
                raise Mat5Error("a small element states more than 4 bytes")
            return first & 0xFFFF, self.take(4)[:count]
        content = self.take(self._whole())
        if first != _COMPRESSED:
            self.at = min(self.at + (-len(content)) % 8, len(self.data))
        return first, content

    def _whole(self) -> int:
        return int.from_bytes(self.take(4), "little" if self.order == "<" else "big")

    def numbers(self) -> np.ndarray:
        """The next element as stored numbers."""
        kind, content = self.element()
        if kind not in _STORED:
            raise Mat5Error(f"numbers are stored as unknown type {kind}")
        dtype = np.dtype(self.order + _STORED[kind])
        if len(content) % dtype.itemsize:
            raise Mat5Error("numbers are cut in the middle")
        return np.frombuffer(content, dtype)

    def text(self) -> str:
        """The next element as text."""
        kind, content = self.element()
        if kind not in _TEXTS:
            raise Mat5Error(f"text is stored as unknown type {kind}")
        suffix = {"<": "-le", ">": "-be"}[self.order] if "utf-" in _TEXTS[kind] else ""
        encoding = _TEXTS[kind] + (suffix if _TEXTS[kind] != "utf-8" else "")
        return content.decode(encoding)


def read_mat5(data: bytes) -> dict[str, Tree]:
    """Variables of a level-5 file: numbers, text, structs, struct arrays and cells.

    Sparse arrays, objects, tables and functions come as None.

    Raises:
        Mat5Error: The file is damaged, or of another level.
    """
    if len(data) < 128 or data[126:128] not in (b"IM", b"MI") or 0 in data[:4]:
        raise Mat5Error("this is no MATLAB file of level 5 or 7.3")
    order = "<" if data[126:128] == b"IM" else ">"
    variables: dict[str, Tree] = {}
    for matrix in _matrices(_Bytes(data, order, 128)):
        name, value = _array(matrix, 0)
        if name:
            variables[name] = value
    return variables


def _matrices(file: _Bytes) -> Iterator[_Bytes]:
    while file.at < len(file.data):
        kind, content = file.element()
        if kind == _COMPRESSED:
            unpacker = zlib.decompressobj()
            unpacked = unpacker.decompress(content, _LARGEST)
            if not unpacker.eof:
                raise Mat5Error("compressed data are incomplete")
            kind, content = _Bytes(unpacked, file.order).element()
        if kind != _MATRIX:
            raise Mat5Error(f"an element of type {kind} stands where a variable should")
        yield _Bytes(content, file.order)


def _array(source: _Bytes, depth: int) -> tuple[str, Tree]:
    """Name and content of one array."""
    if depth > _DEEPEST:
        raise Mat5Error(f"structs are nested more than {_DEEPEST} deep")
    if not source.data:
        return "", np.empty(0)
    flags = source.numbers()
    if len(flags) != 2:
        raise Mat5Error("an array has no flags")
    word = int(flags[0])
    kind = word & 0xFF
    if kind == _OPAQUE:
        return source.text(), None
    shape = tuple(int(n) for n in source.numbers())
    if len(shape) < 2 or min(shape) < 0:
        raise Mat5Error(f"an array has the shape {shape}")
    name = source.text()
    size = math.prod(shape)
    if kind in _NUMERIC:
        return name, _numeric(source, shape, size, bool(word & _COMPLEX))
    if kind == _CHAR:
        return name, source.text() if shape[0] == 1 else None
    if kind == _CELL:
        return name, [_nested(source, depth) for _ in range(_sized(source, size))]
    if kind == _STRUCT:
        return name, _structs(source, size, depth)
    return name, None


def _numeric(source: _Bytes, shape: tuple[int, ...], size: int, pair: bool) -> np.ndarray:
    parts = [source.numbers() for _ in range(2 if pair else 1)]
    if any(len(part) != size for part in parts):
        raise Mat5Error(f"an array of {size} numbers holds {len(parts[-1])}")
    values = parts[0].astype(np.float64)
    if pair:
        values = values + 1j * parts[1].astype(np.float64)
    return values.reshape(shape, order="F")


def _structs(source: _Bytes, size: int, depth: int) -> Tree:
    width = source.numbers()
    if len(width) != 1 or int(width[0]) < 1:
        raise Mat5Error("a struct states no length of its field names")
    _, names = source.element()
    step = int(width[0])
    fields = [
        names[at : at + step].split(b"\x00")[0].decode("utf-8")
        for at in range(0, len(names) - step + 1, step)
    ]
    _sized(source, size * len(fields))
    structs: list[Tree] = [
        {field: _nested(source, depth) for field in fields} for _ in range(size if fields else 0)
    ]
    return structs[0] if len(structs) == 1 else structs


def _sized(source: _Bytes, count: int) -> int:
    """`count`, if that many elements (8 bytes each at least) can be left."""
    if count > (len(source.data) - source.at) // 8:
        raise Mat5Error(f"{count} elements are stated, more than there are bytes for")
    return count


def _nested(source: _Bytes, depth: int) -> Tree:
    kind, content = source.element()
    if kind != _MATRIX:
        raise Mat5Error(f"an element of type {kind} stands where an array should")
    return _array(_Bytes(content, source.order), depth + 1)[1]
