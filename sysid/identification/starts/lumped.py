"""Start values of the lumped model."""

from typing import Any

import numpy as np
from scipy.optimize import nnls

from sysid.identification.features import LoopFeatures
from sysid.identification.starts.ordinary import ordinary_loops
from sysid.identification.starts.plateau import MEAN_FAST
from sysid.models.coordinates import place_of
from sysid.models.lumped import TABLE_1, Lumped
from sysid.models.lumped_coordinates import LumpedCoordinates
from sysid.parameters import build


def lumped_start(features: LoopFeatures | None, coordinates: LumpedCoordinates) -> np.ndarray:
    """Plateaus over speed at each current; what is left of them over temperature; unloading.

    F_y and C_post: intercept and slope of the plateaus against 0.87 v_m, without temperature, as
    both then change with it by the same part.  k: slope of the force over travel
    where it passes zero after a reversal, the more counted the more of the force is yielding.

    Returns:
        [n] solver coordinates.
    """
    reference = coordinates.reference
    f = ordinary_loops(reference) if features is None else features
    f_y, c_post = _plateaus(f, np.array(coordinates.currents), float(reference.force))
    ends = np.array([coordinates.cold, coordinates.warm])
    i = np.abs(f.current)
    strong = np.interp(i, coordinates.currents, f_y)
    expected = strong + np.interp(i, coordinates.currents, c_post) * MEAN_FAST * f.peak_velocity
    fluid = _trend(f.temperature, f.plateau / expected, np.ones_like(i), ends)
    # a loop in which inertia outweighs the spring falls where it should rise
    rising = np.maximum(f.stiffness, f.plateau / float(reference.length))
    stiffness = _trend(f.temperature, rising, (strong / expected) ** 4, ends)
    span = float(np.ptp(ends)) if coordinates.sloped else np.inf

    def line(both: np.ndarray) -> dict[str, Any]:
        slope = (both[1] - both[0]) / span
        return {"intercept": both[0] - slope * ends[0], "slope": slope}

    laws = {"C_post": line(np.outer(fluid, c_post)), "F_y": line(np.outer(fluid, f_y))}
    valve = build(
        Lumped,
        {symbol: TABLE_1[symbol] for symbol in ("C_pre", "m_l", "tau")}
        | {f"k.{end}": float(z) for end, z in line(stiffness).items()}
        | {
            f"{law}[{current:g} A].{end}": float(value)
            for law, ends_of in laws.items()
            for end, column in ends_of.items()
            for current, value in zip(coordinates.currents, column, strict=True)
        },
    )
    return np.asarray(place_of(coordinates, valve))


def _plateaus(
    features: LoopFeatures, currents: np.ndarray, force: float
) -> tuple[np.ndarray, np.ndarray]:
    """F_y and C_post at each current of the table, N and N·s/m, none of them negative.

    Where a current's loops have one speed, the rise of the force at high speed tells them apart.
    """
    nearest = np.argmin(np.abs(np.abs(features.current)[:, None] - currents), axis=1)
    plateau = np.maximum(features.plateau, 1e-3 * force)
    speed = MEAN_FAST * features.peak_velocity
    rise = features.rise.mean(axis=1)
    found, known = [], np.unique(nearest)
    for j in known:
        own = nearest == j
        p, v, r = plateau[own], speed[own], rise[own]
        levels = np.stack([1.0 / p, v / p], axis=1)
        # p = F_y + C_post v and r = C_post/F_y: r v/(1 + r v) of the plateau is viscous
        slopes = 0.3 * np.stack([np.zeros_like(p), v / p], axis=1)
        table = np.concatenate([levels, slopes])
        wanted = np.concatenate([np.ones_like(p), 0.3 * r * v / (1.0 + r * v)])
        scale = np.array([np.median(p), np.median(p) / np.median(v)])
        found.append(np.maximum(nnls(table * scale, wanted)[0], 0.02) * scale)
    rows = np.array(found)
    f_y, c_post = (np.interp(currents, currents[known], row) for row in rows.T)
    return f_y, c_post


def _trend(
    temperature: np.ndarray, values: np.ndarray, weight: np.ndarray, ends: np.ndarray
) -> np.ndarray:
    """Exp of a straight line through log values over temperature, at both ends."""
    logs = np.log(values)
    middle = float(np.average(logs, weights=weight))
    if not np.isfinite(temperature).all() or np.ptp(ends) == 0.0:
        return np.exp(np.full(2, middle))
    line = np.polyfit(temperature, logs, 1, w=np.sqrt(weight))
    return np.exp(np.clip(np.polyval(line, ends), middle - 2.0, middle + 2.0))
