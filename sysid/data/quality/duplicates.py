"""The same measurement under two names."""

import hashlib

import numpy as np

from sysid.data.quality.fault import Fault
from sysid.data.quality.subject import Subject


def check_duplicates(subjects: tuple[Subject, ...]) -> dict[str, list[Fault]]:
    """Tests whose displacement and force are equal, number by number.

    Returns:
        Id → faults, for all but the first of each group.
    """
    first: dict[bytes, Subject] = {}
    faults: dict[str, list[Fault]] = {}
    for subject in subjects:
        record = subject.record
        numbers = np.concatenate([record.displacement, record.force])
        key = hashlib.sha256(np.ascontiguousarray(numbers).tobytes()).digest()
        twin = first.setdefault(key, subject)
        if twin is subject:
            continue
        same = twin.record.nominal == record.nominal
        text = f"all {record.time.size} samples equal those of {twin.record.id!r}" + (
            "" if same else ", under other labels"
        )
        faults[record.id] = [Fault("duplicate", "warning", text)]
    return faults
