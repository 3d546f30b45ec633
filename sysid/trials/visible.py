r"""What a campaign could tell at best: the bound beside which every trial is scored.

With g the planted force, Σ the true covariance of rig errors (and of the structural misfit, where
there is one), J the base Jacobian at the refitted base and P the projection that removes J,

    d′ = ‖P Σ^{-1/2} g‖,   c = |cos| of the angle between P Σ^{-1/2} g and its nearest rival's,

and of two rivals the right one scores higher with probability

    Φ(d′√((1−c)/2)) Φ(d′√((1+c)/2)) + the product of the complements.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.special import ndtr

from sysid.diagnosis.evidence import gather
from sysid.diagnosis.prototypes import prototypes, shape_grid
from sysid.diagnosis.scores import INVISIBLE
from sysid.diagnosis.signatures import signatures
from sysid.effects.base import AbstractEffect
from sysid.identification.result import Fit
from sysid.likelihood.compress import HarmonicBasis
from sysid.likelihood.discrepancy import ROLL_OFF, Covariance, Sizes, covariance_parts
from sysid.likelihood.discrepancy import Parts as CovarianceParts
from sysid.likelihood.reml import full_rank
from sysid.rig.trial_campaign import Trial, make_trial
from sysid.rig.trial_design import TrialDesign

DETECTED: Final = 4.5
"""d′ at which one of 31 candidates is seen with 80 % power at α = .01."""
NAMED: Final = 0.95
"""Probability of the right name from which on an effect counts as visible."""
_NOTHING: Final = 1e-9

Coefficients = Float[np.ndarray, "loop m"]
Columns = Float[np.ndarray, "loop m k"]


@dataclass(frozen=True)
class Visibility:
    """How well one planted effect can be seen in one campaign.

    Attributes:
        distance: d′.
        survival: Share of its energy, weighted by Σ⁻¹, that the base cannot absorb.
        rival: Id of the effect of the catalogue that looks most like it; None without any.
        likeness: c with that rival.
        right: Probability of the right name at best.
        own: Cosine with the catalogue's own effect of that cause at its best shape: below
            `likeness`, the planter looks more like another effect than like its own; NaN for
            what is not in the catalogue.
    """

    distance: float
    survival: float
    rival: str | None
    likeness: float
    right: float
    own: float = float("nan")

    @property
    def detectable(self) -> bool:
        """Something can be seen."""
        return self.distance >= DETECTED

    @property
    def visible(self) -> bool:
        """It can be seen and told apart from its nearest rival."""
        return self.detectable and self.right >= NAMED


def right_name(distance: float, likeness: float) -> float:
    """Probability that of two rivals the right one scores higher.

    Args:
        distance: d′ of the true effect.
        likeness: c, the absolute correlation (not its square) of the two signatures.
    """
    apart = float(ndtr(distance * np.sqrt(max(1.0 - likeness, 0.0) / 2.0)))
    same = float(ndtr(distance * np.sqrt((1.0 + likeness) / 2.0)))
    return apart * same + (1.0 - apart) * (1.0 - same)


def seen_by(
    covariance: Covariance,
    absorbed: Columns,
    planted: Coefficients,
    rivals: Columns,
    owners: Sequence[str],
    causes: Sequence[str] = (),
) -> Visibility:
    """The bound for one planted force.

    Args:
        covariance: True Σ.
        absorbed: [L, m, n], full rank: what the base (and other effects) can take up.
        planted: [L, m] N.
        rivals: [L, m, k], signatures.
        owners: k ids.
        causes: Ids that are no rivals but true.
    """
    every = np.concatenate([absorbed, planted[:, :, None], rivals], axis=2)
    gram = covariance.inner(every, every)
    n = absorbed.shape[2]
    left = gram[n:, n:] - gram[n:, :n] @ np.linalg.solve(gram[:n, :n], gram[:n, n:])
    whole, kept = np.diagonal(gram)[n:], np.maximum(np.diagonal(left), 0.0)
    share = np.divide(kept, whole, out=np.zeros_like(kept), where=whole > 0.0)
    distance = float(np.sqrt(kept[0]))
    lengths = np.sqrt(kept[0] * kept[1:])
    usable = (share[1:] >= INVISIBLE) & (lengths > 0.0)
    cosines = np.divide(left[0, 1:], lengths, out=np.zeros_like(lengths), where=usable)
    mine = np.array([owner in causes for owner in owners], dtype=bool)
    own = float(cosines[mine][np.argmax(np.abs(cosines[mine]))]) if mine.any() else float("nan")
    others = np.where(usable & ~mine, np.abs(cosines), -1.0)
    nearest = int(np.argmax(others)) if others.size else 0
    if not others.size or others[nearest] < 0.0:
        alone = right_name(distance, 0.0)
        return Visibility(distance, float(share[0]), None, 0.0, alone, own)
    c = min(float(others[nearest]), 1.0)
    return Visibility(distance, float(share[0]), owners[nearest], c, right_name(distance, c), own)


def visibilities(
    trial: Trial,
    seed: int,
    design: TrialDesign,
    base: Fit,
    left: Float[np.ndarray, "loop phase"] | None = None,
    effects: Sequence[AbstractEffect] | None = None,
) -> tuple[Visibility, ...]:
    """The bound for every planter of a trial.

    Args:
        trial: With its truth.
        seed: Of the trial.
        design: As it was run.
        base: Refitted to its loops.
        left: [L, J] N, what the base leaves without effects and rig errors; None where nothing.
        effects: Rivals at nominal values; all of the catalogue that loops can show if not given.
    """
    evidence = gather(trial.loops)
    absorbed = full_rank(evidence.look(base.coordinates, base.u)[1])
    covariance = true_covariance(trial, design, evidence.basis, absorbed, left)
    shapes = [
        shape
        for one in (effects or prototypes(evidence.size))
        for shape in shape_grid(one, evidence.size)
    ]
    rivals = signatures(evidence, base.valve, shapes)
    owners = [e.facts.id for e in shapes]
    planted = [evidence.basis.compress(force) for force in planted_alone(trial, seed, design)]
    found = []
    for k, force in enumerate(planted):
        others = [p[:, :, None] for j, p in enumerate(planted) if j != k]
        taken = full_rank(np.concatenate([absorbed, *others], axis=2)) if others else absorbed
        found.append(seen_by(covariance, taken, force, rivals, owners, trial.truth.causes))
    return tuple(found)


def planted_alone(
    trial: Trial, seed: int, design: TrialDesign
) -> list[Float[np.ndarray, "loop phase"]]:
    """What each planter of a trial adds by itself, [L, J] N each."""
    truth = trial.truth
    if len(truth.planters) == 1:
        return [truth.force - truth.force_without]
    alone = [make_trial(seed, (planter,), None, design).truth for planter in truth.planters]
    return [one.force - one.force_without for one in alone]


def true_covariance(
    trial: Trial,
    design: TrialDesign,
    basis: HarmonicBasis,
    absorbed: Columns,
    left: Float[np.ndarray, "loop phase"] | None = None,
) -> Covariance:
    """Σ with the true sizes of the rig's errors, and of the structural misfit as it turned out.

    Args:
        trial: With its truth.
        design: As it was run.
        basis: Harmonics.
        absorbed: [L, m, n], orthonormal: what the base can take up.
        left: [L, J] N, what the base leaves without effects and rig errors; None where nothing.
    """
    rms = np.sqrt(np.mean(trial.truth.force**2, axis=1))
    sigma = np.maximum(design.noise, design.relative_noise * rms)
    points = design.cycles * trial.loops.force.shape[1]
    parts = replace(covariance_parts(trial.loops, basis), noise=sigma / np.sqrt(points))
    odd = _NOTHING if left is None else structural_size(parts, basis.compress(left), absorbed)
    return Covariance(
        parts,
        Sizes(
            gain=max(design.gain_sd, _NOTHING),
            offset=max(design.offset_sd, _NOTHING),
            delay=max(design.delay_sd, _NOTHING),
            odd=max(odd, _NOTHING),
            even=_NOTHING,
        ),
    )


def structural_size(parts: CovarianceParts, left: Coefficients, absorbed: Columns) -> float:
    """Size of the structural term with which a refitted base leaves, on average, what it left.

    A law that is wrong by a factor changes odd harmonics only.  With K the term of size 1 and Q
    the projection that removes what least squares absorbs, E‖left‖² = size² tr(QK).

    Args:
        parts: What Σ is made of.
        left: [L, m] N.
        absorbed: [L, m, n], orthonormal.
    """
    falls = np.where(parts.order % 2 == 1, 1.0, 0.0) / (1.0 + (parts.order / ROLL_OFF) ** 4)
    kernel = parts.kernel * parts.scale[:, None] * parts.scale[None, :]
    whole = float(np.trace(kernel) * falls.sum())
    taken = float(np.einsum("lmn,m,lk,kmn->", absorbed, falls, kernel, absorbed, optimize=True))
    return float(np.sqrt(np.sum(left**2) / max(whole - taken, 1e-300)))
