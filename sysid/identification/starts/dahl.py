"""Start values of the Dahl model."""

import numpy as np

from sysid.identification.features import LoopFeatures
from sysid.identification.starts.ordinary import ordinary_loops
from sysid.identification.starts.plateau import plateau_laws, yield_travel
from sysid.models.coordinates import place_of
from sysid.models.dahl import Dahl
from sysid.models.dahl_coordinates import DahlCoordinates
from sysid.parameters import build


def dahl_start(features: LoopFeatures | None, coordinates: DahlCoordinates) -> np.ndarray:
    """Laws from the plateaus; w passes zero ln 2/ρ after a reversal.

    Returns:
        [n] solver coordinates.
    """
    reference = coordinates.reference
    f = ordinary_loops(reference) if features is None else features
    valve = build(Dahl, plateau_laws(f, reference) | {
        "k_0": 0.0, "rho": np.log(2.0) / yield_travel(f, reference),
    })  # fmt: skip
    return np.asarray(place_of(coordinates, valve))
