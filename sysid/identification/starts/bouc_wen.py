"""Start values of the Bouc–Wen model."""

import numpy as np

from sysid.identification.features import LoopFeatures
from sysid.identification.starts.ordinary import ordinary_loops
from sysid.identification.starts.plateau import plateau_laws, yield_travel
from sysid.models.bouc_wen import BoucWen
from sysid.models.bouc_wen_coordinates import BoucWenCoordinates
from sysid.models.coordinates import place_of
from sysid.parameters import build


def bouc_wen_start(features: LoopFeatures | None, coordinates: BoucWenCoordinates) -> np.ndarray:
    """Laws from the plateaus; with σ = 1 w passes zero π/4ρ after a reversal.

    Returns:
        [n] solver coordinates.
    """
    reference = coordinates.reference
    f = ordinary_loops(reference) if features is None else features
    valve = build(BoucWen, plateau_laws(f, reference) | {
        "k_0": 0.0, "rho": 0.25 * np.pi / yield_travel(f, reference), "sigma": 1.0,
    })  # fmt: skip
    return np.asarray(place_of(coordinates, valve))
