r"""A sparse term that would lower what a model leaves: proposed, never named.

At most two terms are chosen from a library of forces that physics makes, by forward selection: the
one that lowers the weighted residual most, beside the Jacobian of the model, so that nothing is
proposed that the model's own parameters can do.

The choice is tested as a whole.  Each condition (an amplitude and a frequency, with all its
currents) is left out in turn, term and coefficient are chosen anew from the others, and its error
is predicted.  A term is proposed only if that lowers the error by more than two standard errors
over conditions: trying two dozen terms on noise makes unseen conditions worse, not better.

Source:
    Brunton, Proctor & Kutz, PNAS 113 (2016) 3932, for sparse terms from a library; Kaheman et al.,
    arXiv:1909.08574 (2019), for learning what a model lacks instead of the whole.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from jaxtyping import Float, Int

from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.leftover import Leftover, Variables, leftover, squared_error, variables
from sysid.diagnosis.result import Term
from sysid.diagnosis.state import State
from sysid.effects.base import Parity

MOST: Final = 2
"""Terms that are proposed at most."""
FEWEST: Final = 5
"""Conditions below which nothing can be said about unseen ones."""
CERTAIN: Final = 2.0
"""Standard errors over conditions that the gain on unseen conditions must exceed."""
WORTH: Final = 0.05
"""Share of what is left that a term must remove there: less is not worth a proposal."""
SURVIVES: Final = 0.01
"""A term of which less than this is beyond the model's own parameters (and the terms before it) has
a coefficient that means nothing."""

Force = Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray]


def _root(v: np.ndarray) -> np.ndarray:
    return np.sqrt(np.abs(v)) * np.sign(v)


@dataclass(frozen=True)
class Candidate:
    """A force that physics makes, per unit of its coefficient.

    Attributes:
        formula: Of x, v, a, i.
        parity: Of the force on a sinusoid.
        unit: SI, of the coefficient.
        force: Of position, velocity, acceleration and |current|, SI.
    """

    formula: str
    parity: Parity
    unit: str
    force: Force


LIBRARY: Final = (
    Candidate("x", "OC", "N/m", lambda x, v, a, i: x),
    Candidate("x|x|", "OC", "N/m^2", lambda x, v, a, i: x * np.abs(x)),
    Candidate("x³", "OC", "N/m^3", lambda x, v, a, i: x**3),
    Candidate("|i|·x", "OC", "N/(m·A)", lambda x, v, a, i: i * x),
    Candidate("x|v|", "OC", "N·s/m^2", lambda x, v, a, i: x * np.abs(v)),
    Candidate("a", "OC", "kg", lambda x, v, a, i: a),
    Candidate("a|a|", "OC", "kg·s^2/m", lambda x, v, a, i: a * np.abs(a)),
    Candidate("|i|·a", "OC", "kg/A", lambda x, v, a, i: i * a),
    Candidate("sign(v)", "OD", "N", lambda x, v, a, i: np.sign(v)),
    Candidate("|i|·sign(v)", "OD", "N/A", lambda x, v, a, i: i * np.sign(v)),
    Candidate("i²·sign(v)", "OD", "N/A^2", lambda x, v, a, i: i**2 * np.sign(v)),
    Candidate("|x|·sign(v)", "OD", "N/m", lambda x, v, a, i: np.abs(x) * np.sign(v)),
    Candidate("√|v|·sign(v)", "OD", "N·(s/m)^½", lambda x, v, a, i: _root(v)),
    Candidate("v", "OD", "N·s/m", lambda x, v, a, i: v),
    Candidate("v|v|", "OD", "N·s^2/m^2", lambda x, v, a, i: v * np.abs(v)),
    Candidate("|i|·v", "OD", "N·s/(m·A)", lambda x, v, a, i: i * v),
    Candidate("|x|·v", "OD", "N·s/m^2", lambda x, v, a, i: np.abs(x) * v),
    Candidate("1", "EC", "N", lambda x, v, a, i: np.ones_like(x)),
    Candidate("|x|", "EC", "N/m", lambda x, v, a, i: np.abs(x)),
    Candidate("x²", "EC", "N/m^2", lambda x, v, a, i: x**2),
    Candidate("|v|", "EC", "N·s/m", lambda x, v, a, i: np.abs(v)),
    Candidate("v²", "EC", "N·s^2/m^2", lambda x, v, a, i: v**2),
    Candidate("|i|·|v|", "EC", "N·s/(m·A)", lambda x, v, a, i: i * np.abs(v)),
    Candidate("|a|", "EC", "kg", lambda x, v, a, i: np.abs(a)),
    Candidate("x·sign(v)", "ED", "N/m", lambda x, v, a, i: x * np.sign(v)),
    Candidate("|i|·x·sign(v)", "ED", "N/(m·A)", lambda x, v, a, i: i * x * np.sign(v)),
    Candidate("x·v", "ED", "N·s/m^2", lambda x, v, a, i: x * v),
)  # fmt: skip
"""What springs, masses, friction, flow and their asymmetries add to a force, current beside."""


def proposal(evidence: Evidence, state: State) -> tuple[Term, ...]:
    """Terms that lower what a model leaves, also on conditions that did not choose them.

    Args:
        evidence: The campaign.
        state: The model, fitted for free runs.
    """
    table = variables(evidence)
    columns = np.stack([_column(table, c) for c in LIBRARY], axis=2)
    size = np.sqrt(np.mean(columns**2, axis=(0, 1)))
    size = np.where(size > 0.0, size, 1.0)
    left = leftover(evidence, state, columns / size)
    if len(left.grams) < FEWEST:
        return ()
    whole = left.whole
    chosen = forward(left, whole)
    tried = _unseen(left)
    total = float(tried.errors[:, 0].sum())
    found = []
    for k, term in enumerate(chosen):
        gain = tried.errors[:, k] - tried.errors[:, k + 1]
        removes, certainty = (
            float(gain.sum()) / max(total, 1e-300),
            _certainty(gain, tried.moves[:, k]),
        )
        if not (removes > WORTH and certainty > CERTAIN):
            break
        found.append((removes, removes / certainty, np.mean(tried.choices[:, k] == term)))
    kept = chosen[: len(found)]
    value, sd = _coefficients(left, np.array(kept, dtype=int))
    return tuple(
        Term(
            formula=LIBRARY[c].formula,
            parity=LIBRARY[c].parity,
            coefficient=float(value[k] / size[c]),
            unit=LIBRARY[c].unit,
            sd=float(sd[k] / size[c]),
            removes=found[k][0],
            se=found[k][1],
            agreed=float(found[k][2]),
        )
        for k, c in enumerate(kept)
    )


def _column(table: Variables, candidate: Candidate) -> Float[np.ndarray, "loop point"]:
    current = np.abs(np.nan_to_num(table.current)) * np.ones_like(table.position)
    return candidate.force(table.position, table.velocity, table.acceleration, current)


def forward(left: Leftover, gram: Float[np.ndarray, "k k"]) -> list[int]:
    """Numbers of the terms that lower the residual most, one after the other.

    Args:
        left: What the products are of.
        gram: Products over the conditions that may choose.
    """
    count = gram.shape[0] - left.model - 1
    chosen: list[int] = []
    for _ in range(MOST):
        taken = left.places(np.array(chosen))
        rest = np.concatenate([left.model + np.arange(count), [-1]])
        inner = gram[np.ix_(taken, taken)]
        inner = inner + 1e-12 * np.trace(inner) / len(taken) * np.eye(len(taken))
        across = gram[np.ix_(taken, rest)]
        after = gram[np.ix_(rest, rest)] - across.T @ np.linalg.solve(inner, across)
        own, before = np.diagonal(after)[:-1], np.diagonal(gram)[left.model : -1]
        usable = own > SURVIVES * before
        usable[chosen] = False
        if not usable.any():
            break
        lowered = np.where(usable, after[:-1, -1] ** 2 / np.where(usable, own, 1.0), 0.0)
        chosen.append(int(np.argmax(lowered)))
    return chosen


class _Tried(NamedTuple):
    """What terms chosen without a condition predict there.

    Attributes:
        errors: [C, MOST + 1] squared error with 0, 1, … terms.
        moves: [C, MOST] squared change of the prediction by each term.
        choices: [C, MOST] its number; −1 for none.
    """

    errors: Float[np.ndarray, "condition steps"]
    moves: Float[np.ndarray, "condition terms"]
    choices: Int[np.ndarray, "condition terms"]


def _unseen(left: Leftover) -> _Tried:
    """Leave every condition out in turn; choose terms and coefficients from the others."""
    whole, errors, moves, choices = left.whole, [], [], []
    for gram in left.grams:
        picked = forward(left, whole - gram)
        error, move, last = [], [], np.zeros(0)
        for k in range(MOST + 1):
            taken = np.array(picked[:k], dtype=int)
            c, places = left.solved(whole - gram, taken), left.places(taken)
            error.append(squared_error(gram, places, c))
            if k:
                d = c - np.pad(last, (0, c.size - last.size))
                move.append(float(d @ gram[np.ix_(places, places)] @ d))
            last = c
        errors.append(error)
        moves.append(move)
        choices.append([*picked, *[-1] * (MOST - len(picked))])
    return _Tried(np.array(errors), np.array(moves), np.array(choices))


def _certainty(
    gain: Float[np.ndarray, " condition"], move: Float[np.ndarray, " condition"]
) -> float:
    """Gain on unseen conditions in standard errors over conditions.

    With p the change of the prediction and e what it should have been, the gain is 2e·p − p²: p²
    if the term is right, less or negative if it is not.  What varies with p² alone, as it does for
    a term that acts at the largest stroke only, is known beforehand and no uncertainty.  So the
    standard error is that of the ratio Σ gain/Σ p², by leaving conditions out: a condition that
    dominates must be borne out by the others.
    """
    whole = gain.sum() / max(move.sum(), 1e-300)
    others = (gain.sum() - gain) / np.maximum(move.sum() - move, 1e-300)
    se = np.sqrt((gain.size - 1) / gain.size * np.sum((others - others.mean()) ** 2))
    return float(whole / max(se, 1e-300))


def _coefficients(
    left: Leftover, columns: np.ndarray
) -> tuple[Float[np.ndarray, " term"], Float[np.ndarray, " term"]]:
    """Coefficients of terms, and their standard deviations by leaving conditions out."""
    whole, count = left.whole, len(left.grams)
    value = left.solved(whole, columns)[left.model :]
    each = np.array([left.solved(whole - g, columns)[left.model :] for g in left.grams])
    spread = np.sum((each - each.mean(axis=0)) ** 2, axis=0)
    return value, np.sqrt((count - 1) / count * spread)
