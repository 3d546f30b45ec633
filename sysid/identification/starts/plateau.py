"""What the forces at high speed say: yield force and viscosity, with current and without."""

from typing import Final

import numpy as np
from scipy.optimize import nnls

from sysid.identification.features import LoopFeatures
from sysid.models.coordinates import Reference

MEAN_FAST: Final = 0.87
"""Mean of |cos φ| where it exceeds 0.7: the speed of a plateau in peak velocities."""
BEND: Final = 0.5
"""q times the largest current to start from: somewhat saturated."""


def plateau_laws(features: LoopFeatures, reference: Reference) -> dict[str, float]:
    """α_a, α_b, c_a, c_b, q and f_0 from P = α(i) + c(i)·0.87 v_m, none of them negative.

    Every loop counts relative to its own plateau, so that the weak ones are met as well.

    Args:
        features: Of L loops.
        reference: The campaign's magnitudes.

    Returns:
        Symbol → value, SI.
    """
    N, V, I = (float(z) for z in (reference.force, reference.speed, reference.current))  # noqa: E741
    q = BEND / I
    s, effective = -np.expm1(-q * np.abs(features.current)) / q, -np.expm1(-BEND) / q
    plateau = np.maximum(features.plateau, 1e-3 * N)
    speed = MEAN_FAST * features.peak_velocity / V
    columns = [np.ones_like(s), s / effective, speed, speed * s / effective]
    table = np.stack(columns, axis=1) / plateau[:, None]
    found = nnls(table, np.ones_like(s))[0]
    typical = float(np.median(plateau))
    alpha_a, alpha_b, c_a, c_b = np.maximum(found, 0.02 * typical)
    return {
        "alpha_a": alpha_a, "alpha_b": alpha_b / effective,
        "c_a": c_a / V, "c_b": c_b / V / effective,
        "q": q, "f_0": float(np.median(features.offset)),
    }  # fmt: skip


def yield_travel(features: LoopFeatures, reference: Reference) -> float:
    """Travel from a reversal to zero force, m.

    A loop whose force lags passes zero at −w v_m after the reversal, when it has run through
    A (1 − √(1 − w²)).
    """
    lag = float(np.clip(np.median(-features.width), 0.05, 0.9))
    return float(reference.length) * (1.0 - np.sqrt(1.0 - lag**2))
