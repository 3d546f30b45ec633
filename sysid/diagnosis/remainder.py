"""What a fitted model leaves: how much, beyond noise and rig errors, and of what kind."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.state import State
from sysid.likelihood.carried import carried
from sysid.likelihood.discrepancy import LAWS, Sizes
from sysid.uncertainty.directions import directions_of

DIRECTIONS: Final = 6
"""Directions in which the laws of a valve can bend one loop: plateau, slope, width, knee, and how
they differ; further ones are combinations of these to within noise."""
CHANCE: Final = 2.0
"""Standard deviations of the floor that may be chance: a few dozen tests with errors of the rig of
their own leave 15 % more or less than such errors do on the average."""
OTHERWISE: Final = ("odd", "even")
"""Parts of Σ for structural errors of any shape."""


@dataclass(frozen=True)
class Remainder:
    """Energy that a model leaves, each test relative to its max|F|.

    Attributes:
        total: Σ ‖r‖²/max|F|² over tests.
        floor: What noise and rig errors of the sizes found would leave; a fit takes up a part.
        scatter: Standard deviation of that from campaign to campaign.
        law_shaped: Share of what is beyond noise and rig errors that another value of the valve's
            parameters for every loop would explain.
    """

    total: float
    floor: float
    scatter: float
    law_shaped: float

    @property
    def reducible(self) -> float:
        """What is left to explain."""
        return max(self.total - self.floor, 0.0)

    @property
    def may_be_chance(self) -> bool:
        """No more is left than errors of the rig alone may leave."""
        return self.reducible <= CHANCE * self.scatter


def remainder(evidence: Evidence, state: State, sizes: Sizes) -> Remainder:
    """Measure what a model leaves.

    Args:
        evidence: The campaign.
        state: The model, fitted for free runs.
        sizes: Of the rig's errors.
    """
    parts = evidence.parts
    weight = 1.0 / evidence.peak**2
    noise = parts.noise**2
    energies = [
        sizes.gain**2 * np.sum(parts.force**2, axis=1),
        np.full(noise.shape, sizes.offset**2),
        sizes.delay**2 * np.sum(parts.rate**2, axis=1),
    ]
    if parts.warmth.size:
        energies.append(sizes.thermometer**2 * np.sum(parts.warmth**2, axis=1))
    degrees = parts.force.shape[1]
    rig = sum(energies)
    # of ‖r‖² with r ~ N(0, C) it is 2 tr C²; errors of the rig are taken for orthogonal
    variance = 2.0 * (noise**2 * degrees + 2.0 * noise * rig + sum(e**2 for e in energies))
    residual = state.gls.residual
    return Remainder(
        total=float(np.sum(weight * np.sum(residual**2, axis=1))),
        floor=float(np.sum(weight * (noise * degrees + rig))) - _taken_up(evidence, state, sizes),
        scatter=float(np.sqrt(np.sum(weight**2 * variance))),
        law_shaped=_law_shaped(evidence, state),
    )


def _taken_up(evidence: Evidence, state: State, sizes: Sizes) -> float:
    """What parameters take up of noise and rig errors: tr(B Gᵀ Σ G), B = (Σ JᵀJ/p²)⁻¹, G = J/p²."""
    weights = state.gls.jacobian / evidence.peak[:, None, None] ** 2
    seen = directions_of(np.einsum("lmi,lmj->ij", weights, state.gls.jacobian)).seen
    of_the_rig = replace(sizes, **dict.fromkeys((*OTHERWISE, *LAWS), 0.0))
    error = carried(evidence.parts, of_the_rig, weights).sum(axis=0)
    return float(np.trace(seen.T @ error @ seen))


def lawful(evidence: Evidence, state: State) -> float:
    """Part of the structural error that the discrepancy covariance takes for one of the laws.

    The valve's laws err smoothly over conditions and bend loops in a few ways (`LAWS`); what has
    another shape is left to the general structural term.  A missing effect that is not in the
    model goes there, an effect that only stands in for it leaves it there.

    Args:
        evidence: The campaign.
        state: A model fitted under its own Σ.
    """
    r = state.gls.residual
    energy = [evidence.energy(state.covariance.expected(r, names)) for names in (LAWS, OTHERWISE)]
    return energy[0] / sum(energy) if sum(energy) > 0.0 else 0.0


def _law_shaped(evidence: Evidence, state: State) -> float:
    """Share of the residual, less what varies from test to test, inside the span of the laws."""
    valve = state.coordinates.valve_coordinates.size
    parts = evidence.parts
    offset = np.zeros_like(parts.force)
    offset[:, 0] = 1.0
    inside = total = 0.0
    for k in range(evidence.tests):
        rig = np.stack([parts.force[k], offset[k], parts.rate[k]], axis=1)
        rig, _ = np.linalg.qr(rig / np.linalg.norm(rig, axis=0))
        laws = state.gls.jacobian[k, :, :valve]
        laws = laws - rig @ (rig.T @ laws)
        r = state.gls.residual[k] - rig @ (rig.T @ state.gls.residual[k])
        left, singular, _ = np.linalg.svd(laws, full_matrices=False)
        kept = left[:, : min(DIRECTIONS, int((singular > 1e-6 * singular[0]).sum()))]
        noise = parts.noise[k] ** 2
        degrees = r.size - rig.shape[1]
        inside += (np.sum((kept.T @ r) ** 2) - noise * kept.shape[1]) / evidence.peak[k] ** 2
        total += (np.sum(r**2) - noise * degrees) / evidence.peak[k] ** 2
    return float(np.clip(inside / total, 0.0, 1.0)) if total > 0.0 else 0.0
