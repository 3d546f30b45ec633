"""Start values of the modified Bouc–Wen model."""

from typing import Final

import numpy as np

from sysid.identification.features import LoopFeatures
from sysid.identification.starts.ordinary import ordinary_loops
from sysid.identification.starts.plateau import plateau_laws, yield_travel
from sysid.models.coordinates import place_of
from sysid.models.modified_bouc_wen import ModifiedBoucWen
from sysid.models.modified_bouc_wen_coordinates import ModifiedBoucWenCoordinates
from sysid.parameters import build

SERIES: Final = 10.0
"""c_1 over c_0 to start from: about what the source found."""
STIFFNESS: Final = 0.1
"""k_0 in units of force over length."""


def modified_bouc_wen_start(
    features: LoopFeatures | None, coordinates: ModifiedBoucWenCoordinates
) -> np.ndarray:
    """That of the simple model, with a dashpot in series ten times as stiff as its own.

    Returns:
        [n] solver coordinates.
    """
    reference = coordinates.reference
    f = ordinary_loops(reference) if features is None else features
    laws = plateau_laws(f, reference)
    c_a, c_b = laws.pop("c_a"), laws.pop("c_b")
    valve = build(ModifiedBoucWen, laws | {
        "c_0a": c_a, "c_0b": c_b, "c_1a": SERIES * c_a, "c_1b": SERIES * c_b,
        "k_0": STIFFNESS * float(reference.force) / float(reference.length), "k_1": 0.0,
        "rho": 0.25 * np.pi / yield_travel(f, reference), "sigma": 1.0,
    })  # fmt: skip
    return np.asarray(place_of(coordinates, valve))
