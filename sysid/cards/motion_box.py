"""Whether a motion of any shape lies in a card's validity box."""

import numpy as np

from sysid.cards.outside import outside
from sysid.cards.schema import Validity
from sysid.motion.motion import Motion


def motion_outside(
    validity: Validity, motion: Motion, assumed: float | None = None
) -> tuple[str, ...]:
    """Say in which respects a motion [n] leaves the box; its frequency is not asked.

    Args:
        validity: The box.
        motion: Displacement relative to the centre.
        assumed: °C that the damper is simulated at where the motion tells none.
    """
    i, t = np.asarray(motion.current), np.asarray(motion.temperature)
    known = t[np.isfinite(t)]
    if not known.size and assumed is not None:
        known = np.array([assumed])
    return outside(
        validity,
        reach=float(np.abs(motion.displacement).max()),
        velocity=float(np.abs(motion.velocity).max()),
        current=(float(i.min()), float(i.max())),
        temperature=(float(known.min()), float(known.max())) if known.size else None,
    )
