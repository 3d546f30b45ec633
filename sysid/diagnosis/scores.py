r"""Score test: which effects, each added alone, would explain what a model leaves.

No candidate is fitted.  Its signature is the secant of the model in the candidate's size,

    g = [F(θ̂, nominal) − F(θ̂, 0)] / nominal,

so that effects without a derivative at zero (lost motion, clipping) have one too.  With Σ the
discrepancy covariance and P = Σ⁻¹ − Σ⁻¹J(JᵀΣ⁻¹J)⁻¹JᵀΣ⁻¹ the projection that removes whatever the
parameters of the model can absorb,

    score = (gᵀP r)² / gᵀP g  ~ χ²₁ without the effect,
    expected size = gᵀP r / gᵀP g ± 1/√(gᵀP g),   survival = gᵀP g / gᵀΣ⁻¹g.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float
from scipy.special import chdtri

from sysid.diagnosis.absorbed import products
from sysid.effects.base import AbstractEffect
from sysid.likelihood.discrepancy import Covariance
from sysid.parameters import specs

FALSE_ALARM: Final = 0.01
"""Probability that any candidate exceeds its threshold in a campaign without effects."""
INVISIBLE: Final = 0.002
"""A signature of which less than this survives is absorbed by the model's parameters."""


@dataclass(frozen=True)
class Scored:
    """One candidate at its best shape.

    Attributes:
        effect: At the shape (and for some the size) that scores best.
        score: χ²₁ without the effect; 0 where its sign would be impossible.
        threshold: What a score must exceed, all candidates and shapes counted.
        survival: Share of the signature that the model cannot absorb.
        expected: Expected size, in the unit of the size parameter.
        se: Standard error of `expected`.
        signature: [L, m] N per unit of size.
    """

    effect: AbstractEffect
    score: float
    threshold: float
    survival: float
    expected: float
    se: float
    signature: Float[np.ndarray, "loop m"]

    @property
    def visible(self) -> bool:
        """The campaign could show this effect."""
        return self.survival >= INVISIBLE


def score_all(
    shapes: list[AbstractEffect],
    signatures: Float[np.ndarray, "loop m k"],
    residual: Float[np.ndarray, "loop m"],
    jacobian: Float[np.ndarray, "loop m n"],
    covariance: Covariance,
) -> tuple[Scored, ...]:
    """Score every shape of every candidate, keep the best shape of each; best candidates first.

    Args:
        shapes: k effects; those of one id and form are shapes of one candidate.
        signatures: [L, m, k] of the shapes.
        residual: [L, m] N, measured minus model.
        jacobian: [L, m, n] of the model.
        covariance: Σ.
    """
    signals = np.concatenate([signatures, residual[:, :, None]], axis=2)
    whole, projected = products(signals, jacobian, covariance)
    before = np.diagonal(whole)[:-1]
    after = np.maximum(np.diagonal(projected)[:-1], 1e-300)
    along = projected[:-1, -1]
    survival = np.where(before > 0.0, after / np.maximum(before, 1e-300), 0.0)
    possible = np.array([allowed(e, along[k]) for k, e in enumerate(shapes)])
    score = np.where((survival >= INVISIBLE) & possible, along**2 / after, 0.0)
    threshold = float(chdtri(1, FALSE_ALARM / len(shapes)))
    owner = [e.facts.id for e in shapes]
    best: dict[str, int] = {}
    for k, name in enumerate(owner):
        first = best.get(name, k)
        if (score[k], survival[k]) >= (score[first], survival[first]):
            best[name] = k
    found = [
        Scored(
            effect=shapes[k],
            score=float(score[k]),
            threshold=threshold,
            survival=float(survival[k]),
            expected=float(along[k] / after[k]),
            se=float(1.0 / np.sqrt(after[k])),
            signature=signatures[:, :, k],
        )
        for k in best.values()
    ]
    # effects that are one force in these tests come in the order of the catalogue, not of rounding
    return tuple(sorted(found, key=lambda c: (-round(c.score, 3), -round(c.survival, 6))))


def allowed(effect: AbstractEffect, size: float) -> bool:
    """The size parameter has this sign in real dampers and rigs."""
    spec = next(s for s in specs(effect) if s.symbol == effect.facts.size)
    if effect.facts.sign:
        return bool(effect.facts.sign * size > 0.0)
    return bool(math.isinf(spec.low) or size > 0.0)
