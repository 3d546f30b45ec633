"""Chains on disk as they grow: nothing that was drawn and stored is lost, whenever the end comes.

An HDF5 file that is being written when its process is killed may not open again.  So every block of
steps is a file of its own, written beside its place, synchronised, and then moved there, which file
systems do wholly or not at all; a half-written block has no name that anyone looks for.  A block
holds the random states after it, so that the next block is the same whoever computes it.  When the
chain has ended its draws become one file (`posterior_file`) and the folder goes.

    setup.h5        what was found before the first step: sizes, reduced likelihood, jumps, start
    000000.h5 …     blocks
"""

import io
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import h5py
import numpy as np

from sysid.data.whole_file import cannot_write, write_bytes

Arrays = Mapping[str, np.ndarray]

_SETUP: Final = "setup.h5"
_KEY: Final = "key"


class ChainStore:
    """A folder that a chain grows in.

    Args:
        folder: Made when the first thing is stored.
        key: Says which chain this is; what another chain has left in the folder is removed.
    """

    def __init__(self, folder: Path, key: str) -> None:
        self._folder, self._key = folder, key

    def setup(self) -> dict[str, np.ndarray] | None:
        """What was stored before the first step, in its shapes; None if it has not begun.

        Nor has it where that cannot be read: what follows it is of no use then.
        """
        return self._stored(self._folder / _SETUP)

    def begin(self, setup: Arrays) -> None:
        """Start anew.

        Args:
            setup: Arrays of any shape that are kept beside the blocks.

        Raises:
            OutputError: The folder cannot be written.
        """
        try:
            shutil.rmtree(self._folder, ignore_errors=True)
            self._folder.mkdir(parents=True, exist_ok=True)
        except OSError as cause:
            raise cannot_write(self._folder, cause) from cause
        write_arrays(self._folder / _SETUP, setup, self._key)

    def blocks(self) -> list[dict[str, np.ndarray]]:
        """Blocks of this chain that were stored, in order and in their shapes.

        Up to one that is damaged: it and those after it are drawn again, the same.
        """
        found: list[dict[str, np.ndarray]] = []
        while (block := self._stored(self._block(len(found)))) is not None:
            found.append(block)
        return found

    def append(self, number: int, block: Arrays) -> None:
        """Store a block.

        Args:
            number: From 0.
            block: Its arrays, of any shape.

        Raises:
            OutputError: It cannot be written; blocks before it stay.
        """
        write_arrays(self._block(number), block, self._key)

    def remove(self) -> None:
        """Remove the folder, once its content is elsewhere."""
        shutil.rmtree(self._folder, ignore_errors=True)

    def _stored(self, path: Path) -> dict[str, np.ndarray] | None:
        """Arrays of a file of this chain; None where there is none, or none that can be read."""
        try:
            arrays, key = read_arrays(path)
        except (OSError, KeyError):
            return None
        return arrays if key == self._key else None

    def _block(self, number: int) -> Path:
        return self._folder / f"{number:06d}.h5"


def write_arrays(path: Path, arrays: Arrays, key: str) -> None:
    """Write arrays as datasets of an HDF5 file, whole or not at all.

    Args:
        path: Of the file.
        arrays: Name → array of any shape.
        key: Kept as an attribute.

    Raises:
        OutputError: It cannot be written; a file that was there before is untouched.
    """
    buffer = io.BytesIO()
    with h5py.File(buffer, "w", track_order=True) as file:
        for name, array in arrays.items():
            file.create_dataset(name, data=array, track_times=False)
        file.attrs[_KEY] = key
    write_bytes(path, buffer.getvalue())


def read_arrays(path: Path) -> tuple[dict[str, np.ndarray], str]:
    """Arrays, in their shapes, and key of a file that `write_arrays` wrote."""
    with h5py.File(path, "r") as file:
        arrays = {str(name): np.asarray(data) for name, data in file.items()}
        return arrays, str(file.attrs[_KEY])
