"""A test whose force is of another order than that of its neighbours: kN among N."""

from collections.abc import Iterable

import numpy as np
from jaxtyping import Bool, Float

from sysid.data.figures import figure
from sysid.data.quality.fault import Fault
from sysid.data.quality.matrix import ABSOLUTE, RELATIVE, find_levels
from sysid.data.quality.sign import NO_DAMPER
from sysid.data.quality.subject import Subject

FACTOR = 100.0
"""Between two tests at one current, beside the ratio of their speeds: more than temperature makes,
and less than a thousand."""
FEWEST = 2
"""Others that a test is held against, at the same current or, where there are fewer, at any."""
RANGE = 500.0
"""The same as `FACTOR` against tests at more current, whose force is larger: more than the range of
any damper between no current and all, and less than a thousand."""


def check_scale(subjects: Iterable[Subject]) -> dict[str, list[Fault]]:
    """Tests whose force differs by more than `FACTOR` from most others.

    Yield force is the same at every speed and viscous force goes with it; so the ratio of two
    tests' forces lies between 1 and the ratio of their speeds, but for a factor.  A force is
    measured by its median departure from its middle, which spikes leave alone.  A test is held
    against those at its current; with fewer than `FEWEST` of these, against all, where more current
    makes more force: a test at less may have 1/`RANGE` of it, and one at more `RANGE` times as
    much.  Tests whose current is not known are not compared.

    Args:
        subjects: Tests without a fatal fault of their own.

    Returns:
        Id → faults.
    """
    with_damper = [s.loop for s in subjects if s.record.nominal.kind not in NO_DAMPER]
    known = [loop for loop in with_damper if loop is not None and np.isfinite(loop.current)]
    sizes = [float(np.median(np.abs(loop.force - np.median(loop.force)))) for loop in known]
    loops = [loop for loop, size in zip(known, sizes, strict=True) if size > 0.0]
    if len(loops) <= FEWEST:
        return {}
    size = np.array([size for size in sizes if size > 0.0])
    current = np.array([loop.current for loop in loops])
    speed = np.array([loop.frequency * loop.amplitude for loop in loops])
    _, level = find_levels(current, RELATIVE["current_A"], ABSOLUTE["current_A"])
    faults = {}
    for k, loop in enumerate(loops):
        beside = np.arange(len(loops)) != k
        alike = level == level[k]
        few = np.sum(alike & beside) < FEWEST
        others = beside if few else beside & alike
        more = np.where(alike, 0.0, np.abs(current) - abs(current[k]))
        apart = _apart(size, speed, more, k)
        if 2 * np.sum(apart[others]) <= np.sum(others):
            continue
        ratio = size[k] / np.median(size[others])
        times = f"{figure(ratio, 2)} times" if ratio > 1.0 else f"1/{figure(1.0 / ratio, 2)} of"
        tests = f"{np.sum(others)} other tests" + ("" if few else " at the same current")
        makes = "speed, current and temperature" if few else "speed and temperature"
        text = (
            f"the force is {times} that of the {tests} (median), more than {makes} can make: "
            "another unit (kN for N), here or there? Correct the unit in the header or in the "
            "manifest"
        )
        faults[loop.id] = [Fault("force_scale", "fatal", text)]
    return faults


def _apart(
    size: Float[np.ndarray, " n"],
    speed: Float[np.ndarray, " n"],
    more: Float[np.ndarray, " n"],
    k: int,
) -> Bool[np.ndarray, " n"]:
    """Tests of which test k is too far; `more` is what current they have beyond it."""
    force, fast = size[k] / size, speed[k] / speed
    low = np.minimum(1.0, fast) / np.where(more > 0.0, RANGE, FACTOR)
    high = np.maximum(1.0, fast) * np.where(more < 0.0, RANGE, FACTOR)
    return (force < low) | (force > high)
