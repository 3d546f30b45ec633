"""Which parameters, and which combinations of them, the data do not determine, in words."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.sparse.csgraph import connected_components

from sysid.uncertainty.estimate import Estimate

WIDE: Final = 0.5
"""Relative standard deviation above which a direction is left open."""
ANY: Final = 25.0
"""Relative variance from which a direction reaches any factor."""
SHARE: Final = 0.25
"""Share in a wide direction from which a parameter is told to be moved by it, however little."""
JOINED: Final = 0.1
"""Correlation of two parameters in what is left open, from which they are told together."""
NUMBERS: Final = {2: "two", 3: "three", 4: "four", 5: "five", 6: "six"}
AT_END: Final = 1e-3
"""Part of its interval, or of its magnitude where that is smaller, that a value which ended at a
bound is off it: solvers only come near."""


def undetermined(
    symbols: Sequence[str],
    values: np.ndarray,
    relative: np.ndarray,
    parameters: Sequence[Estimate],
) -> tuple[str, ...]:
    """Sentences about what the data leave open.

    Directions are eigenvectors of the covariance of relative changes.  Those that are alike wide
    mix at will; what does not depend on that is the projection onto all of them.  Parameters that
    it joins are told together, with how many numbers they are too many.  Of two that share one
    wide direction the product or the ratio is told, if that remains known.

    Args:
        symbols: [n] free parameters.
        values: [n].
        relative: [n, n] covariance of changes relative to the parameters' magnitudes.
        parameters: Estimates; free ones at a bound are mentioned.
    """
    sentences = [_told(symbols, values, relative, group) for group in _groups(relative)]
    own = dict(zip(symbols, np.sqrt(np.diagonal(relative)).tolist(), strict=True))
    for p in parameters:
        if p.sd <= 0.0 or p.symbol not in own:
            continue
        magnitude = p.sd / own[p.symbol]
        if p.value - p.low < AT_END * min(p.high - p.low, magnitude):
            sentences.append(
                f"{p.symbol} ended at its bound {p.low:g}: its data would rather have less"
            )
    return tuple(sentences)


@dataclass(frozen=True)
class _Group:
    """Parameters that wide directions join.

    Attributes:
        places: Of the parameters, the widest first.
        variances: Of the directions, the widest first.
    """

    places: tuple[int, ...]
    variances: tuple[float, ...]


def _groups(relative: np.ndarray) -> list[_Group]:
    """All of them, the widest first."""
    variance, vectors = np.linalg.eigh(relative)
    wide, sd = vectors[:, variance >= WIDE**2], np.sqrt(variance[variance >= WIDE**2])
    # the wider the direction, the smaller a share in it still moves a parameter by WIDE
    moved = np.flatnonzero((np.abs(wide) > np.minimum(WIDE / sd, SHARE)).any(axis=1))
    onto = wide[moved] @ wide[moved].T
    size = np.sqrt(np.diagonal(onto))
    count, labels = connected_components(np.abs(onto) > JOINED * np.outer(size, size))
    groups = []
    for label in range(count):
        places = moved[labels == label]
        directions = round(float(np.sum(size[labels == label] ** 2))) or 1
        inside = relative[np.ix_(places, places)]
        widest = np.argsort(np.diagonal(inside))[::-1]
        variances = np.linalg.eigvalsh(inside)[::-1][:directions].tolist()
        wide_ones = [v for v in variances[1:] if v >= WIDE**2]  # a part of them may be none
        groups.append(_Group(tuple(places[widest].tolist()), (variances[0], *wide_ones)))
    return sorted(groups, key=lambda group: -group.variances[0])


def _told(symbols: Sequence[str], values: np.ndarray, relative: np.ndarray, group: _Group) -> str:
    names, many = [symbols[k] for k in group.places], len(group.variances)
    listed = names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
    amount = _amount(group.variances)
    if many >= len(names):
        return f"{listed} {'is' if len(names) == 1 else 'are'} not determined ({amount})"
    if len(names) == 2:
        i, j = group.places
        known, sd = _known_combination(symbols, values, relative, i, j)
        if sd < min(WIDE, 0.5 * np.sqrt(min(relative[i, i], relative[j, j]))):
            return (
                f"{listed} run off together ({amount}): "
                f"only {known} is determined, to {100 * sd:.2g} %"
            )
    number = "one number" if many == 1 else f"{NUMBERS.get(many, many)} numbers"
    return f"{listed} trade against each other ({amount}): {number} too many for these data"


def _amount(variances: Sequence[float]) -> str:
    """How far directions reach, the widest first."""
    if variances[-1] >= ANY:
        return "any factor"
    least = f"±{100 * np.sqrt(variances[-1]):.0f} %"
    return least if len(variances) == 1 else f"{least} and more"


def _known_combination(
    symbols: Sequence[str], values: np.ndarray, relative: np.ndarray, i: int, j: int
) -> tuple[str, float]:
    """Ratio or product of two parameters, whichever is known better, and its relative sd."""
    both, cross = relative[i, i] + relative[j, j], relative[i, j]
    signs = np.sign(values[i] * values[j])
    ratio, product = both - 2 * signs * cross, both + 2 * signs * cross
    if ratio <= product:
        value = values[i] / values[j] if values[j] else np.nan
        return f"{symbols[i]}/{symbols[j]} = {value:.4g}", float(np.sqrt(max(ratio, 0.0)))
    return f"{symbols[i]}·{symbols[j]} = {values[i] * values[j]:.4g}", float(
        np.sqrt(max(product, 0.0))
    )
