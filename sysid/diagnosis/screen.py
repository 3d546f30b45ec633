r"""Score screen: which effects, each added alone, would explain what the base model leaves.

No candidate is fitted.  Its signature is the secant of the model in the candidate's size,

    g = [F(θ̂, nominal) − F(θ̂, 0)] / nominal,

so that effects without a derivative at zero (lost motion, clipping) have one too.  With Σ the
discrepancy covariance and P = Σ⁻¹ − Σ⁻¹J(JᵀΣ⁻¹J)⁻¹JᵀΣ⁻¹ the projection that removes whatever the
base parameters can absorb,

    score = (gᵀP r)² / gᵀP g  ~ χ²₁ without the effect,
    expected size = gᵀP r / gᵀP g ± 1/√(gᵀP g),   survival = gᵀP g / gᵀΣ⁻¹g.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float
from scipy.special import chdtri

from sysid.diagnosis.compress import HarmonicBasis
from sysid.diagnosis.discrepancy import Covariance
from sysid.effects.base import AbstractEffect
from sysid.effects.registry import EFFECTS, choices, make
from sysid.identification.result import Fit
from sysid.models.coordinates import AbstractCoordinates
from sysid.models.damper import Damper
from sysid.motion.motion import Motion

FALSE_ALARM: Final = 0.01
"""Probability that any candidate exceeds its threshold in a campaign without effects."""
INVISIBLE: Final = 0.002
"""A signature of which less than this survives is absorbed by the base parameters."""


@dataclass(frozen=True)
class Candidate:
    """One effect as the screen sees it, at its best shape.

    Attributes:
        effect: The effect at its nominal size and best shape parameters.
        score: χ²₁ without the effect.
        threshold: What a score must exceed, all candidates and shapes counted.
        survival: Share of the signature that the base parameters cannot absorb.
        expected: Expected size, in the unit of the size parameter.
        standard_error: Of `expected`.
        signature: [L, m] N per unit of size.
    """

    effect: AbstractEffect
    score: float
    threshold: float
    survival: float
    expected: float
    standard_error: float
    signature: Float[np.ndarray, "loop m"]

    @property
    def visible(self) -> bool:
        """The campaign could show this effect."""
        return self.survival >= INVISIBLE


@dataclass(frozen=True)
class Screen:
    """All candidates, best first, and how alike they look.

    Attributes:
        candidates: Sorted by score, those that the campaign cannot show last.
        likeness: [k, k] cos² between their signatures after whitening and projection; 0 for those
            that the campaign cannot show.
    """

    candidates: tuple[Candidate, ...]
    likeness: Float[np.ndarray, "k k"]


def screen(
    fit: Fit,
    motion: Motion,
    residual: Float[np.ndarray, "loop phase"],
    effects: Sequence[AbstractEffect],
    covariance: Covariance,
    basis: HarmonicBasis,
    jacobian: Float[np.ndarray, "loop m n"],
) -> Screen:
    """Score every effect on the residual of a fitted base model.

    Args:
        fit: The base model.
        motion: Of L loops.
        residual: [L, J] N, measured minus simulated.
        effects: Candidates at their nominal values.
        covariance: Σ in the harmonics of `basis`.
        basis: Harmonics.
        jacobian: [L, m, n], of the base model in the same harmonics, full rank.
    """
    shapes = [shape for effect in effects for shape in shape_grid(effect)]
    owner = np.array([shape.facts.id for shape in shapes])
    signatures = np.stack(
        [basis.compress(np.asarray(signature(fit.valve, motion, e))) for e in shapes], axis=2
    )
    r = basis.compress(residual)
    every = np.concatenate([jacobian, signatures, r[:, :, None]], axis=2)
    gram = covariance.inner(every, every)
    n = jacobian.shape[2]
    projected = gram[n:, n:] - gram[n:, :n] @ np.linalg.solve(gram[:n, :n], gram[:n, n:])
    before = np.diagonal(gram)[n:-1]
    after = np.maximum(np.diagonal(projected)[:-1], 1e-300)
    score = projected[:-1, -1] ** 2 / after
    survival = np.where(before > 0.0, after / np.maximum(before, 1e-300), 0.0)
    score = np.where(survival >= INVISIBLE, score, 0.0)
    best = [
        int(np.flatnonzero(owner == name)[np.argmax(score[owner == name])])
        for name in dict.fromkeys(owner)
    ]
    threshold = float(chdtri(1, FALSE_ALARM / len(shapes)))
    found = [
        Candidate(
            effect=shapes[k],
            score=float(score[k]),
            threshold=threshold,
            survival=float(survival[k]),
            expected=float(projected[k, -1] / after[k]),
            standard_error=float(1.0 / np.sqrt(after[k])),
            signature=signatures[:, :, k],
        )
        for k in best
    ]
    order = sorted(range(len(found)), key=lambda k: -found[k].score)
    index = np.array([best[k] for k in order])
    visible = survival[index] >= INVISIBLE
    length = np.where(visible, np.sqrt(after[index]), np.inf)
    likeness = (projected[np.ix_(index, index)] / length[:, None] / length[None, :]) ** 2
    return Screen(tuple(found[k] for k in order), likeness)


def signature(
    valve: eqx.Module, motion: Motion, effect: AbstractEffect
) -> Float[Array, "loop phase"]:
    """[F(nominal) − F(0)] / nominal size, N per unit of the size parameter."""
    return _signature(Damper(valve, (effect,)), motion)  # type: ignore[arg-type]  # a valve model


@eqx.filter_jit
def _signature(damper: Damper, motion: Motion) -> Float[Array, "loop phase"]:
    effect = damper.effects[0]
    size = getattr(effect, effect.facts.size)
    absent = Damper(damper.valve, (with_value(effect, effect.facts.size, jnp.zeros_like(size)),))
    return (damper.force(motion) - absent.force(motion)) / size


def shape_grid(effect: AbstractEffect) -> list[AbstractEffect]:
    """The effect with each of its shape parameters at low, nominal and high realistic values.

    Shape parameters mean nothing while the size is zero, so the largest score over a grid is used
    and the number of shapes is counted in the threshold (Davies, Biometrika 64 (1977)).
    """
    facts = effect.facts
    known = [s for s in facts.nominal if s != facts.size and s in facts.realistic]
    grids = [sorted({*facts.realistic[s], facts.nominal[s]}) for s in known]
    result = []
    for values in product(*grids):
        changed = effect
        for symbol, value in zip(known, values, strict=True):
            changed = with_value(changed, symbol, jnp.asarray(value))
        result.append(changed)
    return result


def with_value(effect: AbstractEffect, symbol: str, value: Array) -> AbstractEffect:
    """The effect with one parameter changed."""
    return eqx.tree_at(lambda e: getattr(e, symbol), effect, value)


@eqx.filter_jit
def base_jacobian(
    coordinates: AbstractCoordinates, u: Float[Array, " n"], motion: Motion
) -> Float[Array, "loop phase n"]:
    """Derivative of the force with respect to the solver coordinates, N."""
    _, push = jax.linearize(lambda z: coordinates.valve(z).force(motion), u)
    return jnp.moveaxis(jax.vmap(push)(jnp.eye(u.size)), 0, 2)


def prototypes() -> tuple[AbstractEffect, ...]:
    """Every effect that steady loops can show, in each of its forms, at nominal values."""
    return tuple(
        make(kind, choice=form)
        for kind in EFFECTS
        if kind.facts.found_from == "loops"
        for form in choices(kind)
    )
