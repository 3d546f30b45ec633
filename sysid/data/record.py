"""One measured test, whole, in SI units, and where every number of it came from."""

from dataclasses import dataclass, field
from typing import Final, Literal

import numpy as np
from jaxtyping import Float

Kind = Literal["sine", "triangle", "random", "current_step", "rod_disconnected", "tare"]

OWN_GRID: Final[tuple[Kind, ...]] = ("triangle", "random", "current_step")
"""Kinds of motion that give no loop but show the damper nevertheless, each on its own time grid."""

Array = Float[np.ndarray, " n"]


@dataclass(frozen=True)
class Conditions:
    """What a test was meant to be (labels, not measurements); None where nothing says.

    Attributes:
        amplitude: Half the stroke, m.
        frequency: Hz.
        current: Commanded current, A.
        voltage: Drive voltage of rigs that record no current, V. Never taken for a current.
        temperature: °C.
        temperature_sd: Standard deviation of `temperature`, K.
        run_order: Position of the test in the campaign, from 1; history effects need it.
        kind: Kind of excitation.
    """

    amplitude: float | None = None
    frequency: float | None = None
    current: float | None = None
    voltage: float | None = None
    temperature: float | None = None
    temperature_sd: float | None = None
    run_order: int | None = None
    kind: Kind = "sine"


@dataclass(frozen=True)
class Source:
    """Provenance of a record.

    Attributes:
        file: Path relative to the campaign's folder, with forward slashes.
        sha256: Hash of the whole file, hexadecimal.
        part: Which part of the file (sheet, group, block, test key), if it holds several tests.
        changes: Every change made to the numbers on the way in, one sentence each (unit
            conversions, sign flips, a time axis rebuilt, rows left out).
    """

    file: str
    sha256: str
    part: str | None = None
    changes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Record:
    """One measured test: everything in the file, ramps and rest included.

    Compression is positive; force is positive when it resists compression.  Displacement is as
    recorded (its centre is found with the loops).

    Attributes:
        id: The file's stem, with its folders before it where files in several have one stem (and
            ``#part`` appended where one file holds several tests).
        time: [n] s, strictly increasing.
        displacement: [n] m.
        force: [n] N.
        velocity: [n] m/s, if recorded.  Only ever used to check the displacement.
        current: [n] A, if recorded.
        voltage: [n] V, if recorded.
        temperature: [n] °C, if recorded.
        nominal: What the test was meant to be.
        source: Where it came from.
    """

    id: str
    time: Array
    displacement: Array
    force: Array
    velocity: Array | None = None
    current: Array | None = None
    voltage: Array | None = None
    temperature: Array | None = None
    nominal: Conditions = field(default_factory=Conditions)
    source: Source = field(default_factory=lambda: Source("", ""))
