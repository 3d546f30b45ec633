"""Numbers of many curves in few characters: whole numbers of 16 bits with a scale, in base64."""

import base64
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from sysid.report.page.one_test import OneTest, Traces

LARGEST: Final = 32000
"""Of the whole numbers: a curve keeps its range to one part in 64 000, finer than any screen."""


@dataclass(frozen=True)
class Packed:
    """value = middle + step · whole number.

    Attributes:
        middle: In the curve's unit.
        step: Likewise.
        numbers: Little-endian, base64.
    """

    middle: float
    step: float
    numbers: str

    def json(self) -> list[Any]:
        """For the page's script."""
        return [self.middle, self.step, self.numbers]


def pack(values: np.ndarray) -> Packed | None:
    """Pack a curve of [n] values; None where it has values that are no numbers."""
    y = np.asarray(values, dtype=np.float64)
    if not y.size or not np.isfinite(y).all():
        return None
    low, high = float(y.min()), float(y.max())
    middle = _short(0.5 * (low + high))
    step = _short(max(high - middle, middle - low) / LARGEST) or 1.0
    whole = np.clip(np.rint((y - middle) / step), -32767, 32767).astype("<i2")
    return Packed(middle, step, base64.b64encode(whole.tobytes()).decode("ascii"))


def unpack(packed: Packed) -> np.ndarray:
    """The curve again, [n], as the script does it."""
    whole = np.frombuffer(base64.b64decode(packed.numbers), dtype="<i2")
    return packed.middle + packed.step * whole.astype(np.float64)


def packed_test(test: OneTest) -> dict[str, Any]:
    """What the script draws a test from; strings go into text nodes only."""
    told: dict[str, Any] = {"id": test.id, "why": test.why}
    return told if test.traces is None else told | _curves(test.traces)


def _curves(t: Traces) -> dict[str, Any]:
    def json(values: np.ndarray, scale: float = 1.0) -> list[Any] | None:
        packed = pack(scale * values)
        return None if packed is None else packed.json()

    along: Any = t.along.size if t.over == "phase" else json(t.along)
    return {
        "over": t.over, "along": along, "x": json(t.displacement, 1e3), "v": json(t.velocity),
        "f": json(t.force), "m": [json(f) for f in t.models],
    }  # fmt: skip


def _short(value: float) -> float:
    """Six digits: what is lost is taken up by the whole numbers."""
    return float(f"{value:.6g}")
