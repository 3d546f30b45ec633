"""Start values of the Carreau–Yasuda model."""

import numpy as np

from sysid.identification.features import LoopFeatures
from sysid.identification.starts.ordinary import ordinary_loops
from sysid.identification.starts.plateau import plateau_laws
from sysid.models.carreau import Carreau
from sysid.models.carreau_coordinates import CarreauCoordinates
from sysid.models.coordinates import place_of
from sysid.parameters import build


def carreau_start(features: LoopFeatures | None, coordinates: CarreauCoordinates) -> np.ndarray:
    """Laws from the plateaus, v_0 = plateau over slope at zero force, h = −w v_m.

    Returns:
        [n] solver coordinates.
    """
    reference = coordinates.reference
    f = ordinary_loops(reference) if features is None else features
    laws = plateau_laws(f, reference)
    q, V = laws.pop("q"), float(reference.speed)
    plateau = np.maximum(f.plateau, 1e-3 * float(reference.force))
    onset = np.clip(1.0 / np.median(f.slope / plateau) / V, 0.01, 1.0)
    shift = float(np.clip(np.median(-f.width * f.peak_velocity) / V, -0.5, 0.5))
    valve = build(Carreau, laws | {
        # s(i) = g(i)/q where g has order 1
        "alpha_b": laws["alpha_b"] / q, "c_b": laws["c_b"] / q, "i_s": 1.0 / q, "m": 1.0,
        "k": 0.0, "v_0": onset * V, "n": 3.0, "h_a": shift * V, "h_b": 0.0,
    })  # fmt: skip
    return np.asarray(place_of(coordinates, valve))
