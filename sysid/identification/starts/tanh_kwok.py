"""Start values of the hyperbolic-tangent model."""

import numpy as np

from sysid.identification.features import LoopFeatures
from sysid.identification.starts.ordinary import ordinary_loops
from sysid.identification.starts.plateau import plateau_laws
from sysid.models.coordinates import place_of
from sysid.models.tanh_kwok import TanhKwok
from sysid.models.tanh_kwok_coordinates import TanhKwokCoordinates
from sysid.parameters import build


def tanh_kwok_start(features: LoopFeatures | None, coordinates: TanhKwokCoordinates) -> np.ndarray:
    """Laws from the plateaus, β from the slope at zero force over the plateau, δ = −β w v_m.

    Returns:
        [n] solver coordinates.
    """
    reference = coordinates.reference
    f = ordinary_loops(reference) if features is None else features
    plateau = np.maximum(f.plateau, 1e-3 * float(reference.force))
    beta = np.clip(np.median(f.slope / plateau) * float(reference.speed), 1.0, 100.0)
    beta /= float(reference.speed)
    shift = float(np.clip(np.median(-beta * f.width * f.peak_velocity), -3.0, 3.0))
    valve = build(TanhKwok, plateau_laws(f, reference) | {
        "k": 0.0, "beta": beta, "delta_a": shift, "delta_b": 0.0,
    })  # fmt: skip
    return np.asarray(place_of(coordinates, valve))
