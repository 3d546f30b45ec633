"""Generalised least squares: parameters of any model under the discrepancy covariance Σ."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.likelihood.discrepancy import Covariance

Evaluate = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""u [n] → residual [L, m] N (measured minus model) and Jacobian [L, m, n] of the model."""

FLAT: Final = 1e-12
"""Curvature, parts of the largest, below which a direction counts as undetermined and is damped."""
STILL: Final = 1e-8
"""A parameter to which the cost is less sensitive than this, relative to the most sensitive one,
has run off to where it means nothing; it stays where it is."""
LONGEST: Final = 3.0
"""Longest step of a parameter; solver coordinates are of order one."""
ROUNDING: Final = 1e-10
"""Change of the cost, parts of it, that rounding hides."""
LARGEST: Final = 1e120
"""N; forces beyond it are no forces, and their squares would overflow."""
TOLERANCE: Final = 1e-6
"""Decrease of the cost that is not worth a step, unless told otherwise."""
ROOM: Final = 0.9
"""Part of what a step may leave more, before a bound is reached, that it is to take up at most."""
INSIDE: Final = 1.5
"""A step that left too much aims lower by so many times what it was too much."""
AT_BOUND: Final = 0.1
"""Decrease of the cost that is not worth a step where only a bound holds the parameters."""
FINER: Final = 50
"""Halvings of the exponent of a multiplier."""
_FIRST_DAMPING: Final = 1e-3
_LEAST_DAMPING: Final = 1e-7
_GROWTH: Final = 8.0
_MOST_DAMPING: Final = 1e8


@dataclass(frozen=True)
class GlsFit:
    """Where a generalised least-squares fit ended.

    Attributes:
        u: [n] parameters.
        cost: rᵀΣ⁻¹r there, and the prior's part if there is one.
        residual: [L, m] N, measured minus model.
        jacobian: [L, m, n] of the model.
        information: [n, n] JᵀΣ⁻¹J, without the prior's; its inverse, where it has one, is the
            covariance of u if Σ is that of the residual.
        steps: Evaluations after the first.
        converged: What a further step gains is below the tolerance.
    """

    u: Float[np.ndarray, " n"]
    cost: float
    residual: Float[np.ndarray, "loop m"]
    jacobian: Float[np.ndarray, "loop m n"]
    information: Float[np.ndarray, "n n"]
    steps: int
    converged: bool


@dataclass(frozen=True)
class Bound:
    """Most that a fit may leave: Σ_t w_t ‖r_t‖² ≤ `most`.

    Attributes:
        weight: [L] w, 1/N².
        most: Pure number.
        first: Coefficient of r_t from which on it counts; those before are free.
    """

    weight: Float[np.ndarray, " loop"]
    most: float
    first: int = 0

    def left(self, residual: Float[np.ndarray, "loop m"]) -> float:
        """Σ_t w_t ‖r_t‖²."""
        return float(self.weight @ np.sum(residual[:, self.first :] ** 2, axis=1))


@dataclass(frozen=True)
class _Leash:
    """What a step leaves, by the same linear model as the cost: left − 2 gᵀd + dᵀHd."""

    left: float
    most: float
    target: float
    downhill: np.ndarray  # [n], in u times its scale
    curvature: np.ndarray  # [n, n]

    def holds(self, move: np.ndarray) -> bool:
        """The step keeps to the bound."""
        more = move @ self.curvature @ move - 2.0 * self.downhill @ move
        return bool(self.left + more <= self.target)


@dataclass(frozen=True)
class _Point:
    """The quadratic model of the cost at u: cost − 2 gᵀd + dᵀHd."""

    u: np.ndarray
    cost: float
    residual: np.ndarray
    jacobian: np.ndarray
    information: np.ndarray
    stiffest: np.ndarray  # [n] √ of the largest diagonal of H met so far, the scale of u
    unit: np.ndarray  # [n] its inverse, 1 where it is zero
    downhill: np.ndarray  # [n] g, in u times that scale
    curvature: np.ndarray  # [n] eigenvalues of H in them
    axes: np.ndarray  # [n, n] eigenvectors
    leash: _Leash | None

    @property
    def beyond(self) -> float:
        """How much it leaves beyond the bound; negative where it keeps to it."""
        return -np.inf if self.leash is None else self.leash.left - self.leash.most

    def tightened(self, beyond: float) -> "_Point":
        """The same, with steps that leave less than one that turned out to leave too much."""
        if self.leash is None:
            return self
        return replace(self, leash=replace(self.leash, target=self.leash.target - INSIDE * beyond))

    def step(self, damping: float) -> tuple[np.ndarray, float]:
        """Damped step, and how much the quadratic model says it lowers the cost."""
        stiff, along = self._stiff(damping), self.axes.T @ self.downhill
        move = along / stiff
        if self.leash is not None and not self.leash.holds(self.axes @ move):
            move = self._held(stiff, self.leash)
        gain = 2.0 * along @ move - self.curvature @ move**2
        return np.clip(self.unit * (self.axes @ move), -LONGEST, LONGEST), float(gain)

    @property
    def bounded(self) -> bool:
        """An undamped step would not keep to the bound by itself."""
        move = self.axes @ ((self.axes.T @ self.downhill) / self._stiff(0.0))
        return self.leash is not None and not self.leash.holds(move)

    def _stiff(self, damping: float) -> np.ndarray:
        return self.curvature + FLAT * self.curvature[-1] + np.finfo(float).tiny + damping

    def _held(self, stiff: np.ndarray, leash: _Leash) -> np.ndarray:
        """The step, along the axes, that ends on the bound: with Lagrange's multiplier on it."""
        own, other = self.axes.T @ self.downhill, self.axes.T @ leash.downhill
        bent = self.axes.T @ leash.curvature @ self.axes
        ordinary = float(np.log(stiff.sum() / np.trace(bent)))
        low, high, held = ordinary - 40.0, ordinary + 40.0, np.zeros_like(own)
        for _ in range(FINER):
            middle = 0.5 * (low + high)
            multiplier = np.exp(middle)
            move = np.linalg.solve(np.diag(stiff) + multiplier * bent, own + multiplier * other)
            if leash.holds(self.axes @ move):
                high, held = middle, move
            else:
                low = middle
        return held


def gauss_newton(
    evaluate: Evaluate,
    u0: Float[np.ndarray, " n"],
    covariance: Covariance,
    *,
    prior_precision: Float[np.ndarray, "n n"] | None = None,
    bound: Bound | None = None,
    max_steps: int = 20,
    tolerance: float = TOLERANCE,
) -> GlsFit:
    """Minimise rᵀΣ⁻¹r + (u − u₀)ᵀΠ(u − u₀) by Gauss–Newton steps, damped where needed.

    Levenberg–Marquardt on the Gram matrix of [J r], damped in proportion to the largest curvature
    that each parameter has had, so that one that ceases to matter does not run off.  Directions
    that move nothing are left where they are.  No step is taken to where the model is not finite.
    A bound is kept to, step by step, with a multiplier on what the linear model leaves.

    Args:
        evaluate: The model; called once a step.
        u0: [n] start, and mean of the prior.
        covariance: Σ.
        prior_precision: [n, n] Π; none if None.
        bound: On the residual; the start is within.
        max_steps: Largest number of steps tried.
        tolerance: Fit ends when a further undamped step promises to lower the cost by less than
            this, or by less than this part of the cost per datum if that exceeds one: parameters
            are then within √tolerance of their standard errors.  It also ends when two lightly
            damped steps running gain no more than that, as along a valley that has run flat, and
            when steps had to become so short that the next one promises no more, as at a kink.

    Raises:
        ValueError: The model is not finite at the start, or leaves more than it may.

    Source:
        Moré, in Numerical Analysis, Lecture Notes in Mathematics 630 (1978): the scale.
        H. B. Nielsen, Damping parameter in Marquardt's method, IMM-REP-1999-05 (1999): damping that
        grows the faster the more steps running have failed.
    """
    start = np.array(u0, dtype=float)
    prior = np.zeros((start.size, start.size)) if prior_precision is None else prior_precision

    def look(u: np.ndarray, stiffest: np.ndarray) -> _Point | None:
        return _look(evaluate, u, covariance, prior, u - start, stiffest, bound)

    here = look(start, np.zeros(start.size))
    if here is None:
        raise ValueError("the model is not finite where the fit starts")
    if here.beyond > 0.0:
        raise ValueError("the model leaves more than it may where the fit starts")
    damping, steps, idle, overshot, growth = _FIRST_DAMPING, 0, 0, 0, _GROWTH
    while not (converged := idle > 1 or here.step(0.0)[1] <= _worth(here, tolerance)):
        if steps >= max_steps or damping > _MOST_DAMPING:
            break
        move, promised = here.step(damping)
        if promised <= (_worth(here, tolerance) if damping > _FIRST_DAMPING else 0.0):
            break
        there, steps = look(here.u + move, here.stiffest), steps + 1
        if there is not None and there.beyond > 0.0:
            here, there, overshot = here.tightened(there.beyond), None, overshot + 1
            if overshot == 1:  # nearly the same step may do, a little shorter where the bound bends
                continue
        kept = -np.inf if there is None else (here.cost - there.cost) / promised
        if there is not None and kept > 0.0:
            little = here.cost - there.cost <= _worth(here, tolerance)
            idle = idle + 1 if little and damping <= _FIRST_DAMPING else 0
            here, overshot = there, 0
        if kept > 0.75:
            damping = max(0.1 * damping, _LEAST_DAMPING)
        elif kept < 0.25:
            damping *= growth
        growth = 2.0 * growth if kept <= 0.0 else _GROWTH
    return GlsFit(
        here.u, here.cost, here.residual, here.jacobian, here.information, steps, converged
    )


def _worth(here: _Point, tolerance: float) -> float:
    """The smallest decrease of the cost that matters."""
    per_datum = here.cost / here.residual.size
    least = max(tolerance, AT_BOUND) if here.bounded else tolerance
    return max(least * max(1.0, per_datum), ROUNDING * here.cost)


def _look(
    evaluate: Evaluate,
    u: np.ndarray,
    covariance: Covariance,
    prior: np.ndarray,
    away: np.ndarray,
    stiffest: np.ndarray,
    bound: Bound | None,
) -> _Point | None:
    """The cost and its quadratic model at u; None where that is not finite."""
    residual, jacobian = (np.asarray(z, dtype=float) for z in evaluate(u))
    both = np.concatenate([jacobian, residual[:, :, None]], axis=2)
    if not np.abs(both).max() < LARGEST:
        return None
    gram = covariance.inner(both, both)
    information = gram[:-1, :-1]
    full = information + prior
    stiffest = np.maximum(stiffest, np.sqrt(np.maximum(np.diagonal(full), 0.0)))
    matters = stiffest > STILL * stiffest.max(initial=0.0)
    unit = np.where(matters, 1.0 / np.where(matters, stiffest, 1.0), 0.0)
    curvature, axes = np.linalg.eigh(full * unit[:, None] * unit[None, :])
    return _Point(
        u=u,
        cost=float(gram[-1, -1] + away @ prior @ away),
        residual=residual,
        jacobian=jacobian,
        information=information,
        stiffest=stiffest,
        unit=unit,
        downhill=unit * (gram[:-1, -1] - prior @ away),
        curvature=np.maximum(curvature, 0.0),
        axes=axes,
        leash=None if bound is None else _leash(bound, both, unit),
    )


def _leash(bound: Bound, both: np.ndarray, unit: np.ndarray) -> _Leash:
    """The bound's quadratic model, from [J r], [L, m, n + 1] N, with u in `unit`."""
    both = both[:, bound.first :]
    rows = (np.sqrt(bound.weight)[:, None, None] * both).reshape(-1, both.shape[2])
    gram = rows.T @ rows
    left = float(gram[-1, -1])
    return _Leash(
        left=left,
        most=bound.most,
        target=left + ROOM * max(bound.most - left, 0.0),
        downhill=unit * gram[:-1, -1],
        curvature=gram[:-1, :-1] * unit[:, None] * unit[None, :],
    )
