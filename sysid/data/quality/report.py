"""The result of an inspection: conditions as measured, repeatability, faults, test matrix."""

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

import numpy as np

from sysid.data.cycles import LoopSet
from sysid.data.quality.fault import Fault
from sysid.data.quality.matrix import test_matrix
from sysid.data.record import Conditions, Kind

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class TestQuality:
    """One test: what it was as measured, and what is wrong with it.

    Attributes:
        id: Id of the record.
        nominal: What it was meant to be.
        amplitude: m, of the displacement's fundamental (None without a steady part).
        frequency: Hz, likewise.
        centre: m, likewise.
        current: A, recorded or as labelled.
        temperature: °C, recorded or as labelled.
        cycles: Whole steady cycles.
        noise_floor: N (None with fewer than two cycles).
        peak_force: N, largest magnitude on the mean loop (of the record without a loop).
        left_out: Why the test gives no loop, one sentence; None if it gives one.
        faults: What the checks found, the most severe first.
        remarks: Which samples are not in the loop, one sentence each.
        changes: What was done to the numbers on reading, and what of the file was not read.
    """

    __test__ = False  # pytest takes names that begin with Test for its own

    id: str
    nominal: Conditions
    amplitude: float | None
    frequency: float | None
    centre: float | None
    current: float | None
    temperature: float | None
    cycles: int
    noise_floor: float | None
    peak_force: float
    left_out: str | None
    faults: tuple[Fault, ...]
    remarks: tuple[str, ...]
    changes: tuple[str, ...]

    @property
    def kind(self) -> Kind:
        """Kind of excitation, as declared."""
        return self.nominal.kind

    @property
    def fatal(self) -> bool:
        """Whether a fit on this test is meaningless."""
        return any(fault.fatal for fault in self.faults)

    def to_dict(self) -> dict[str, object]:
        """The test's entry in `sysid check --json`: units in the keys, null where unknown."""
        speed = None
        if self.amplitude is not None and self.frequency is not None:
            speed = 2.0 * np.pi * self.frequency * self.amplitude
        return {
            "id": self.id,
            "kind": self.kind,
            "amplitude_m": self.amplitude,
            "frequency_Hz": self.frequency,
            "peak_velocity_m/s": speed,
            "centre_m": self.centre,
            "current_A": self.current,
            "temperature_degC": self.temperature,
            "cycles": self.cycles,
            "noise_floor_N": self.noise_floor,
            "peak_force_N": self.peak_force,
            "left_out": self.left_out,
            "faults": [asdict(fault) for fault in self.faults],
            "remarks": list(self.remarks),
            "changes": list(self.changes),
        }


@dataclass(frozen=True)
class QualityReport:
    """All tests of a campaign.

    Attributes:
        name: The campaign's.
        tests: In the order of its records.
        cut: The loops on which the checks worked.
        untrusted: Why a fit of this campaign would be meaningless, one sentence each.
    """

    name: str
    tests: tuple[TestQuality, ...]
    cut: LoopSet
    untrusted: tuple[str, ...]

    @property
    def trustworthy(self) -> bool:
        """False when a fault makes a fit of the campaign meaningless."""
        return not self.untrusted

    def to_frame(self) -> "pd.DataFrame":
        """One row a test, indexed by id; faults as one text."""
        import pandas as pd

        rows = []
        for test in self.tests:
            row = test.to_dict()
            row["faults"] = ", ".join(f"{f.kind} ({f.severity})" for f in test.faults)
            row["remarks"] = "; ".join(test.remarks)
            row["changes"] = "; ".join(test.changes)
            rows.append(row)
        return pd.DataFrame(rows).set_index("id") if rows else pd.DataFrame()

    def matrix(self) -> "pd.DataFrame":
        """The test matrix with what is missing: see `matrix.test_matrix`."""
        nominal = {test.id: test.nominal for test in self.tests}
        return test_matrix(self.cut.loops, [nominal[name] for name in self.cut.loops.ids])
