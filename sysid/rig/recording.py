"""What the recorder stores of a test, and the file that it writes."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float, Int

Samples = Float[np.ndarray, " n"]
Counts = Int[np.ndarray, " n"]

_HEADER: Final = "time_s,displacement_mm,force_N,current_A,temperature_degC\n"


@dataclass(frozen=True)
class Recording:
    """One test as the recorder stores it: integers in units of the last digit written.

    Attributes:
        rate: Sampling rate, Hz.
        displacement: [n] µm.
        force: [n] 0.1 N.
        current: [n] mA.
        temperature: [n] 0.1 °C.
    """

    rate: int
    displacement: Counts
    force: Counts
    current: Counts
    temperature: Counts


def digitise(values: Samples) -> Counts:
    """[n] the nearest integer, as a converter of the recorder gives it."""
    return np.rint(values).astype(np.int64)


def csv_text(recording: Recording) -> bytes:
    """The recorder's integers with their decimal points."""
    places = 3 if 1000 % recording.rate == 0 else 4
    columns = (
        [f"{k / recording.rate:.{places}f}" for k in range(recording.force.size)],
        [f"{x / 1000:.3f}" for x in recording.displacement.tolist()],
        [f"{force / 10:.1f}" for force in recording.force.tolist()],
        [f"{current / 1000:.3f}" for current in recording.current.tolist()],
        [f"{temperature / 10:.1f}" for temperature in recording.temperature.tolist()],
    )
    rows = (",".join(row) for row in zip(*columns, strict=True))
    return (_HEADER + "\n".join(rows) + "\n").encode("ascii")
