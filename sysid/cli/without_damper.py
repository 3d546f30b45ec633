"""What records without a damper say: mean forces, told and never subtracted.

A tare and a run with the rod disconnected show the load cell's zero and the mass of the fixture.
Nothing is done with them by itself: a zero that was taken before the tests need not be theirs.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from sysid.data.cycles import cut_loop
from sysid.data.figures import figure
from sysid.data.quality.sign import NO_DAMPER
from sysid.data.record import Record
from sysid.data.steady import NoSteadyPartError, find_steady

DIGITS = 3
"""Significant digits of a mean force."""


def told_without_damper(records: Sequence[Record]) -> tuple[str, ...]:
    """One sentence with the force of every record without a damper; none without such records.

    Args:
        records: Tests of the campaign, of whatever kind.
    """
    told = list(_each(record for record in records if record.nominal.kind in NO_DAMPER))
    if not told:
        return ()
    return (
        f"Without the damper the mean force is {', '.join(told)} (positive resists compression). "
        "Nothing of it was subtracted: if it is the load cell's zero, it is in the forces of all "
        "other tests, so in their gas force, and in what a model has for it. No key of "
        "campaign.toml takes it off; subtract it from the forces in the files.",
    )


def _each(records: Iterator[Record]) -> Iterator[str]:
    for record in records:
        force = record.force[np.isfinite(record.force)]
        mean = f"{figure(float(force.mean()), DIGITS)} N" if force.size else "not known"
        mass = _mass(record) if record.nominal.kind == "rod_disconnected" else None
        more = "" if mass is None else f"; force over acceleration {figure(mass, DIGITS)} kg"
        yield f"{mean} in {record.id} ({record.nominal.kind}{more})"


def _mass(record: Record) -> float | None:
    """Σ F a/Σ a² over the mean cycle, kg; None where there is no steady motion."""
    try:
        loop = cut_loop(record, find_steady(record))
    except NoSteadyPartError:
        return None
    mass = float(loop.force @ loop.acceleration / (loop.acceleration @ loop.acceleration))
    return mass if np.isfinite(mass) else None
