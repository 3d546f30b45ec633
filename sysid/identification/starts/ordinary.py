"""What to start from where there is no loop to look at."""

import numpy as np

from sysid.identification.features import LoopFeatures
from sysid.models.coordinates import Reference


def ordinary_loops(reference: Reference) -> LoopFeatures:
    """Features of loops of an ordinary damper: gain of five, width of a tenth of v_m."""
    force, V = float(reference.force), float(reference.speed)
    current = float(reference.current)
    i = np.array([0.0, 0.0, current, current])
    plateau = force * np.array([0.2, 0.4, 1.0, 1.6])
    v_m = np.array([0.3, 1.0, 0.3, 1.0]) * V
    return LoopFeatures(
        plateau=plateau, offset=np.zeros(4), width=np.array([-0.05, -0.05, -0.15, -0.15]),
        slope=plateau / (0.1 * v_m), rise=np.full((4, 2), 0.5 / V), peak_velocity=v_m, current=i,
        stiffness=plateau / (0.02 * float(reference.length)), temperature=np.full(4, np.nan),
    )  # fmt: skip
