"""An exported damper, built and called from Python."""

import ctypes
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from sysid.cards.export.c_program import c_program
from sysid.cards.export.compiler import compiler, shared_library
from sysid.cards.export.pieces import pieces_of
from sysid.cards.schema import Card
from sysid.models.damper import Damper
from tests.cards.example import example_card

NAME = "unit"
COMPUTED = (0, 4)
"""Codes of a force that was computed, inside what the card was identified in and outside."""

needs_compiler = pytest.mark.skipif(compiler() is None, reason="there is no C compiler here")


class Program:
    """The shared library of one damper, and one damper in it."""

    def __init__(self, model: str, damper: Damper, folder: Path, card: Card | None = None) -> None:
        files = c_program(card or example_card(), pieces_of(damper, model), NAME)
        self.source = files[f"{NAME}.c"]
        data, why = shared_library(files, NAME, ".so", visible=True)
        assert data is not None, why
        path = folder / f"{model}-{len(list(folder.iterdir()))}.so"
        path.write_bytes(data)
        self.library = ctypes.CDLL(str(path))
        head = files[f"{NAME}.h"]
        size = int(head.split("double memory[")[1].split("]")[0])
        self.memory = (ctypes.c_double * size)()
        self.library[f"{NAME}_init"](self.memory)

    def reset(self) -> None:
        self.library[f"{NAME}_reset"](self.memory)

    def step(self, sample: Sequence[float]) -> tuple[float, int]:
        row, force = (ctypes.c_double * 6)(*sample), ctypes.c_double(np.nan)
        code = self.library[f"{NAME}_step"](self.memory, row, ctypes.byref(force))
        return force.value, code

    def outside(self) -> int:
        return self.library[f"{NAME}_outside"](self.memory)

    def run(self, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Forces and codes of samples, [n, 6]."""
        found = [self.step(row) for row in rows.tolist()]
        return np.array([f for f, _ in found]), np.array([c for _, c in found])

    def in_plant(
        self, sample: Sequence[float], mass: float, rest: float
    ) -> tuple[float, float, int]:
        row = (ctypes.c_double * 6)(*sample)
        a, force = ctypes.c_double(), ctypes.c_double()
        call = self.library[f"{NAME}_step_in_plant"]
        call.argtypes = (
            ctypes.c_void_p, ctypes.c_void_p, ctypes.c_double, ctypes.c_double,
            ctypes.c_void_p, ctypes.c_void_p,
        )  # fmt: skip
        code = call(self.memory, row, mass, rest, ctypes.byref(a), ctypes.byref(force))
        return a.value, force.value, code


def random_rows(points: int = 1200, seed: int = 3) -> np.ndarray:
    """Time, displacement, velocity, no acceleration, current, temperature at unequal steps."""
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.uniform(0.6e-3, 1.4e-3, points))
    x, v = np.zeros(points), np.zeros(points)
    for f in (0.4, 0.7, 1.3, 2.9, 4.1, 7.3):
        a, phase = 0.006 / f, rng.uniform(0.0, 2.0 * np.pi)
        x += a * np.sin(2 * np.pi * f * t + phase)
        v += a * 2 * np.pi * f * np.cos(2 * np.pi * f * t + phase)
    current = 0.2 + 0.19 * np.sin(2 * np.pi * 3.0 * t)
    warm = 40.0 + 15.0 * np.sin(2 * np.pi * 0.5 * t)
    return np.stack([t, x, v, np.full(points, np.nan), current, warm], axis=1)
