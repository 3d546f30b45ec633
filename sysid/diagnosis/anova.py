r"""Functional analysis of variance of what a model leaves: with what does it vary?

The residual is regressed on an additive model of small functions of position, velocity,
acceleration, current, temperature and frequency, and of pairs of them, beside the Jacobian of the
model.  The worth of a set S of quantities is the share of the left energy that functions of S
predict on conditions that they were not fitted to,

    w(S) = max over T ⊆ S of 1 − (held-out error with functions of T)/(held-out error without).

On sinusoids quantities go together: acceleration is position at one frequency, and a loop is told
by position as well as by velocity.  So no quantity has a share of its own, and three numbers say
how far the tests tell it from the others: what it explains alone, w({q}); what nothing else can
explain, w(all) − w(all but q); and its fair share between the two (Shapley), which add up to what
all explain.

Source:
    Owen, SIAM/ASA J. Uncertainty Quantification 2 (2014) 245: Shapley values of dependent inputs.
"""

from collections.abc import Callable, Iterable
from dataclasses import fields
from functools import cache
from itertools import combinations
from math import factorial
from typing import Final

import numpy as np
from jaxtyping import Float
from numpy.polynomial.legendre import legvander
from scipy.interpolate import BSpline

from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.leftover import Variables, leftover, variables
from sysid.diagnosis.result import Anova, Dependence, Joint
from sysid.diagnosis.state import State

GROUPS: Final = 12
"""Groups of conditions that are left out in turn."""
FEWEST: Final = 5
"""Conditions below which nothing can be said about unseen ones."""
QUANTILES: Final = (0.35, 0.7)
"""Of |z|: where the pieces of a function of a moving quantity meet, on both sides of zero."""
RIDGES: Final = (1e-4, 1e-3, 1e-2, 1e-1)
"""Shrinkage that is tried, in parts of the energy of all tests."""
TOLD: Final = 0.02
"""Share from which a pair is told."""
MOVING: Final = ("position", "velocity", "acceleration")
Subset = frozenset[str]


def anova(evidence: Evidence, state: State) -> Anova | None:
    """With what the residual of a model varies; None with too few conditions.

    Args:
        evidence: The campaign.
        state: The model, fitted for free runs.
    """
    if np.unique(evidence.condition).size < FEWEST:
        return None
    table = variables(evidence)
    names = tuple(f.name for f in fields(Variables) if _varies(getattr(table, f.name)))
    blocks = _blocks(table, names)
    owner = np.concatenate([np.full(b.shape[2], k) for k, b in enumerate(blocks.values())])
    columns = np.concatenate([_unit(b, evidence) for b in blocks.values()], axis=2)
    products = leftover(evidence, state, columns, GROUPS)
    keys = list(blocks)
    nothing = products.held_out(np.empty(0)).sum()
    ridges = [z * evidence.tests for z in RIDGES]

    def raw(chosen: Iterable[Subset], ridge: float) -> float:
        numbers = [keys.index(c) for c in chosen]
        error = products.held_out(np.flatnonzero(np.isin(owner, numbers)), ridge).sum()
        return float(1.0 - error / max(nothing, 1e-300))

    ridge = max(ridges, key=lambda z: raw(keys, z))

    @cache
    def worth(subset: Subset) -> float:
        smaller = [worth(subset - {q}) for q in subset]
        return max(0.0, *smaller, raw((k for k in keys if k <= subset), ridge))

    whole = frozenset(names)
    pairs = []
    for pair in (k for k in keys if len(k) == 2):
        additive = raw((k for k in keys if k < pair), ridge)
        beyond = worth(pair) - max(additive, *(worth(frozenset({q})) for q in pair))
        if beyond > TOLD:
            first, second = (n for n in names if n in pair)
            pairs.append(Joint(first, second, beyond))
    return Anova(
        explained=worth(whole),
        constant=worth(frozenset()),
        quantities=tuple(
            sorted(
                (
                    Dependence(
                        quantity=q,
                        share=_fair(q, names, worth),
                        alone=worth(frozenset({q})) - worth(frozenset()),
                        only=worth(whole) - worth(whole - {q}),
                    )
                    for q in names
                ),
                key=lambda d: -d.share,
            )
        ),
        pairs=tuple(sorted(pairs, key=lambda p: -p.share)),
    )


def _fair(q: str, names: tuple[str, ...], worth: Callable[[Subset], float]) -> float:
    """Shapley value: what a quantity adds, averaged over all orders of adding them."""
    others, n = [z for z in names if z != q], len(names)
    total = 0.0
    for size in range(n):
        weight = factorial(size) * factorial(n - size - 1) / factorial(n)
        for subset in map(frozenset, combinations(others, size)):
            total += weight * (worth(subset | {q}) - worth(subset))
    return total


def _varies(values: np.ndarray) -> bool:
    return bool(np.isfinite(values).all() and np.ptp(values) > 1e-6 * np.abs(values).max())


def _blocks(
    table: Variables, names: tuple[str, ...]
) -> dict[Subset, Float[np.ndarray, "loop point k"]]:
    """A constant, functions of each quantity, and products of such functions for each pair."""
    single = {q: _functions(q, getattr(table, q)) for q in names}
    blocks: dict[Subset, np.ndarray] = {frozenset(): np.ones((*table.position.shape, 1))}
    shape = table.position.shape
    for q in names:
        blocks[frozenset({q})] = np.broadcast_to(single[q], (*shape, single[q].shape[2]))
    for one, other in combinations(names, 2):
        moving = [q in MOVING for q in (one, other)]
        a, b = single[one], single[other]
        if all(moving):
            a, b = (_few(q, getattr(table, q)) for q in (one, other))
        product = a[:, :, :, None] * b[:, :, None, :]
        blocks[frozenset({one, other})] = np.broadcast_to(
            product.reshape(*product.shape[:2], -1), (*shape, a.shape[2] * b.shape[2])
        )
    return blocks


def _functions(name: str, values: np.ndarray) -> Float[np.ndarray, "loop point k"]:
    """Cubic splines of what moves; a line and a parabola of what is constant in a test."""
    if name not in MOVING:
        z = np.log(values) if name == "frequency" else values
        z = (2.0 * z - z.min() - z.max()) / np.ptp(z)
        return legvander(z, 2)[:, :, 1:]
    z = values / np.abs(values).max()
    inner = np.quantile(np.abs(z), QUANTILES)
    knots = np.concatenate([[-1.0] * 4, -inner[::-1], inner, [1.0] * 4])
    table = BSpline.design_matrix(np.clip(z, -1.0, 1.0).ravel(), knots, 3).toarray()
    return _with_step(name, z, table.reshape(*z.shape, -1))


def _few(name: str, values: np.ndarray) -> Float[np.ndarray, "loop point k"]:
    """Polynomials of what moves, up to the third degree."""
    z = values / np.abs(values).max()
    return _with_step(name, z, legvander(z, 3)[:, :, 1:])


def _with_step(name: str, z: np.ndarray, columns: np.ndarray) -> Float[np.ndarray, "loop point k"]:
    """Functions of velocity may jump where it changes sign, as those of friction do."""
    return (
        np.concatenate([columns, np.sign(z)[:, :, None]], axis=2) if name == "velocity" else columns
    )


def _unit(block: np.ndarray, evidence: Evidence) -> np.ndarray:
    """Columns of the same weighted energy, so that one ridge shrinks all alike."""
    energy = np.mean((block / evidence.peak[:, None, None]) ** 2, axis=(0, 1))
    return block / np.sqrt(np.maximum(energy, 1e-300))
