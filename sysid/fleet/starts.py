"""Start values of a whole fleet, from the fundamental of every loop's force.

The features of `identification.features` look at zero crossings and at the force near the highest
speeds.  Where a loop is so wide that the force does not pass zero before the rod turns (|v_h| near
v_m or beyond), there is neither.  The fundamental of the force is always there: its phase behind
the velocity tells the width, its size the plateau.
"""

from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Final

import jax
import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops
from sysid.fleet.stack import Stack
from sysid.identification.features import LoopFeatures, loop_features
from sysid.identification.starts.generalized import generalized_start
from sysid.models.generalized_coordinates import GeneralizedCoordinates, Variant

WIDEST: Final = 1.3
"""rad, phase behind the velocity from which on a loop is taken to be wider than v_m."""
BEYOND: Final = 1.5
"""Its width then, over v_m."""
ORDINARY: Final = 10.0
"""Its slope then, in plateaus over v_m."""


def fleet_starts(
    fleet: Sequence[Loops], stack: Stack, variant: Variant
) -> Float[np.ndarray, "damper n"]:
    """One start of every damper.

    Args:
        fleet: Loops of D dampers.
        stack: The same.
        variant: Of the model.
    """
    loops = _joined(fleet)
    features = phase_features(loops, loop_features(loops))
    ends = np.cumsum([len(one.ids) for one in fleet])
    starts = []
    for k, end in enumerate(ends):
        own = _rows(features, slice(end - len(fleet[k].ids), end))
        reference = jax.tree.map(lambda z, k=k: z[k], stack.reference)
        starts.append(generalized_start(own, GeneralizedCoordinates(reference, variant)))
    return np.array(starts)


def phase_features(loops: Loops, features: LoopFeatures) -> LoopFeatures:
    """The same features with plateau and width from the fundamental of the force.

    A force ±P that switches at v = −v_h has the fundamental (4/π) P, and lags by ψ with
    sin ψ = −v_h/v_m.

    Args:
        loops: L tests.
        features: As from `loop_features`.
    """
    points = loops.force.shape[1]
    phase = 2.0 * np.pi * np.arange(points) / points
    with_speed = 2.0 * (loops.force @ np.cos(phase)) / points
    with_travel = 2.0 * (loops.force @ np.sin(phase)) / points
    lag = np.arctan2(with_travel, with_speed)
    beyond = np.abs(lag) > WIDEST
    plateau = 0.25 * np.pi * np.hypot(with_speed, with_travel)
    return replace(
        features,
        plateau=plateau,
        width=-np.where(beyond, BEYOND * np.sign(lag), np.sin(lag)),
        slope=np.where(beyond, ORDINARY * plateau / features.peak_velocity, features.slope),
    )


def _joined(fleet: Sequence[Loops]) -> Loops:
    """All loops of all dampers as if of one."""
    columns = {}
    for field in fields(Loops):
        parts = [getattr(loops, field.name) for loops in fleet]
        if isinstance(parts[0], np.ndarray):
            columns[field.name] = np.concatenate(parts)
        elif isinstance(parts[0], tuple):
            columns[field.name] = tuple(one for part in parts for one in part)
    return Loops(**{**columns, "start_phase": None})


def _rows(features: LoopFeatures, rows: slice) -> LoopFeatures:
    return LoopFeatures(*(getattr(features, field.name)[rows] for field in fields(features)))
