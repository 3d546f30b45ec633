r"""Is the size of an effect that was found the same in all tests, as its formula says?

A formula claims how its force goes by amplitude, frequency and current, and leaves one number open:
a gas spring has one stiffness.  Something else that looks alike within a loop is found as well, at
the size that suits most of the tests.  So the size is let vary from test to test,

    s_l = s (1 + c_0 + Σ_q Σ_k c_qk b_k(q_l)),   q = ln A, ln f, |i|,

b_1 a straight line and b_2 a parabola in q, uncorrelated over the tests in the proportion in which
the effect acts there.  With g_l the effect's force, C its columns g_l b_k(q_l), r what the model
leaves and P the projection that removes the model's parameters (`absorbed`), G = CᵀPC, z = CᵀPr,

    gained = ½ zᵀG⁻¹z − ½ rank G,

the log-likelihood that varying sizes gain, less what they gain by chance: zᵀG⁻¹z is χ² if the
formula is right.  Σ holds the errors of the laws, so a right effect beside wrong laws gains little.

Formulas are never quite the damper's own.  One that is off by a tenth of its force leaves about a
hundredth of the evidence for it, one that is off by half of it a quarter: so an effect is refuted
where the freedom to vary is worth more than half of what the effect itself was worth, and where the
sizes differ by more than half of their mean.
"""

from dataclasses import dataclass
from typing import Final

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from sysid.diagnosis.absorbed import products
from sysid.diagnosis.contenders import LEAST_GAIN
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.prototypes import size_of
from sysid.diagnosis.scores import INVISIBLE
from sysid.diagnosis.signatures import signatures
from sysid.diagnosis.state import State
from sysid.effects.base import AbstractEffect
from sysid.models.coordinates import valve_at

REFUTED: Final = 0.5
"""Part of an effect's own gain, and of its mean size, that its variation must exceed."""
ALIKE: Final = 1e-3
"""Eigenvalue of the correlation of columns below which these tests do not tell them apart."""
ACTS: Final = 1e-6
"""Part of the largest energy from which an effect acts in a test."""


@dataclass(frozen=True)
class VariedSize:
    """The size of one effect, let vary with the condition.

    Attributes:
        id: Of the effect.
        gained: Log-likelihood, less what chance gains.
        spread: Standard deviation of the sizes over their mean, tests counting by the energy of
            the effect in them.
        quantity: "amplitude", "frequency" or "current", by which it varies most; None if by none.
        least: Lowest of the quantity where the effect acts; m, Hz or A.
        most: Highest.
        at_least: Size there, in the unit of the size parameter, varying with this quantity alone.
        at_most: The same at the highest.
    """

    id: str
    gained: float
    spread: float
    quantity: str | None = None
    least: float = float("nan")
    most: float = float("nan")
    at_least: float = float("nan")
    at_most: float = float("nan")

    def refutes(self, gain: float) -> bool:
        """The effect's formula is not what acts.

        Args:
            gain: Log-likelihood that the effect gained when it was added.
        """
        return self.gained > max(LEAST_GAIN, REFUTED * gain) and self.spread > REFUTED


def varied_size(evidence: Evidence, state: State, index: int) -> VariedSize:
    """Let the size of one effect of a model vary with amplitude, frequency and current.

    Args:
        evidence: The campaign.
        state: The model, fitted under its own Σ.
        index: Of the effect.
    """
    damper = valve_at(state.coordinates, jnp.asarray(state.u))
    effect = damper.effects[index]
    size = size_of(effect)
    force = size * signatures(evidence, damper.valve, (effect,))[:, :, 0]
    weight = np.sum(force**2, axis=1) / evidence.peak**2
    id = effect.facts.id
    if not weight.any():
        return VariedSize(id, 0.0, 0.0)
    jacobian = _without_size(state, effect)
    loops = evidence.loops
    quantities = {
        "amplitude": (loops.amplitude, np.log(loops.amplitude)),
        "frequency": (loops.frequency, np.log(loops.frequency)),
        "current": (np.abs(np.nan_to_num(loops.current)),) * 2,
    }
    bases = {name: curve(scale, weight) for name, (_, scale) in quantities.items()}
    every = np.concatenate(list(bases.values()), axis=1)
    gram = _products(force, every, state, jacobian)
    whole = _freed(gram, every, np.arange(every.shape[1]))
    ends, alone, first = np.cumsum([0, *(b.shape[1] for b in bases.values())]), {}, None
    for k, name in enumerate(bases):
        alone[name] = _freed(gram, every, np.arange(ends[k], ends[k + 1]))
        if alone[name].gained > (0.0 if first is None else alone[first].gained):
            first = name
    if first is None:
        return VariedSize(id, whole.gained, _spread(whole.factor, weight))
    there = np.flatnonzero(weight > ACTS * weight.max())
    values = quantities[first][0]
    low, high = (int(there[f(values[there])]) for f in (np.argmin, np.argmax))
    return VariedSize(
        id=id,
        gained=whole.gained,
        spread=_spread(whole.factor, weight),
        quantity=first,
        least=float(values[low]),
        most=float(values[high]),
        at_least=size * float(alone[first].factor[low]),
        at_most=size * float(alone[first].factor[high]),
    )


def curve(
    quantity: Float[np.ndarray, " loop"], weight: Float[np.ndarray, " loop"]
) -> Float[np.ndarray, "loop k"]:
    """A straight line and a parabola in a quantity, of mean 0 and variance 1, uncorrelated.

    Args:
        quantity: [L].
        weight: [L] by which tests count.

    Returns:
        [L, k], k = 2, or less where the quantity has fewer than three levels.
    """
    weight = weight / weight.sum()
    found = [np.ones_like(quantity)]
    centre = quantity - weight @ quantity
    reach = float(np.sqrt(weight @ centre**2))
    if reach <= 1e-6 * (np.abs(quantity).max() + 1e-300):
        return np.zeros((quantity.size, 0))
    for power in (1, 2):
        column = (centre / reach) ** power
        before = float(np.sqrt(weight @ column**2))
        for other in found:
            column = column - (weight @ (column * other)) * other
        after = float(np.sqrt(weight @ column**2))
        if after > 1e-3 * before:
            found.append(column / after)
    return np.stack(found[1:], axis=1)


def _without_size(state: State, effect: AbstractEffect) -> Float[np.ndarray, "loop m n"]:
    """Jacobian of all parameters but the size: the effect's force takes its place."""
    place = state.coordinates.free.index(f"{effect.facts.id}.{effect.facts.size}")
    return np.delete(state.gls.jacobian, place, axis=2)


def _products(
    force: Float[np.ndarray, "loop m"],
    factors: Float[np.ndarray, "loop k"],
    state: State,
    jacobian: Float[np.ndarray, "loop m n"],
) -> Float[np.ndarray, "q q"]:
    """Products of force, its columns and the residual beside the model, q = k + 2.

    Columns that the model absorbs are zero.
    """
    columns = force[:, :, None] * factors[:, None, :]
    signals = np.concatenate([force[:, :, None], columns, state.gls.residual[:, :, None]], axis=2)
    before, after = products(signals, jacobian, state.covariance)
    own, left = np.diagonal(before), np.diagonal(after)
    gone = left <= INVISIBLE * own
    gone[[0, -1]] = left[[0, -1]] <= 0.0
    return np.where(gone[:, None] | gone[None, :], 0.0, after)


@dataclass(frozen=True)
class _Freed:
    """Some columns were fitted: what that gains, and each test's size in parts of the one size."""

    gained: float
    factor: Float[np.ndarray, " loop"]


def _freed(
    gram: Float[np.ndarray, "q q"], factors: Float[np.ndarray, "loop k"], taken: np.ndarray
) -> _Freed:
    """Fit the force and some of its columns to the residual.

    Args:
        gram: Products of [force, columns, residual].
        factors: b_k(q_l).
        taken: Numbers of the columns.
    """
    force = gram[0, 0]
    places = 1 + taken[np.diagonal(gram)[1 + taken] > 0.0]
    none = np.ones(factors.shape[0])
    if not force > 0.0 or places.size == 0:
        return _Freed(0.0, none)
    both = np.append(places, gram.shape[0] - 1)
    rest = gram[np.ix_(both, both)] - np.outer(gram[both, 0], gram[0, both]) / force
    scale = np.sqrt(np.maximum(np.diagonal(gram)[places], 1e-300))
    value, vector = np.linalg.eigh(rest[:-1, :-1] / np.outer(scale, scale))
    solid = value > ALIKE
    along = vector[:, solid].T @ (rest[:-1, -1] / scale)
    c = vector[:, solid] @ (along / value[solid]) / scale
    gained = 0.5 * float(np.sum(along**2 / value[solid])) - 0.5 * int(solid.sum())
    common = (gram[0, -1] - gram[0, places] @ c) / force
    return _Freed(gained, none + common + factors[:, places - 1] @ c)


def _spread(factor: Float[np.ndarray, " loop"], weight: Float[np.ndarray, " loop"]) -> float:
    """Standard deviation over mean, both weighted."""
    mean = float(weight @ factor) / float(weight.sum())
    variance = float(weight @ (factor - mean) ** 2) / float(weight.sum())
    return float(np.sqrt(variance)) / max(abs(mean), 1e-300)
