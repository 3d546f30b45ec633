"""Which parameters, and which combinations of them, the data do not determine, in words."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from sysid.uncertainty.estimate import Estimate

WIDE: Final = 0.5
"""Relative standard deviation above which a direction is left open."""
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

    Directions are eigenvectors of the covariance of relative changes.  A wide direction that two
    parameters share is said as the product or the ratio of them that remains known.

    Args:
        symbols: [n] free parameters.
        values: [n].
        relative: [n, n] covariance of changes relative to the parameters' magnitudes.
        parameters: Estimates; free ones at a bound are mentioned.
    """
    variance, vectors = np.linalg.eigh(relative)
    sentences = []
    for k in np.argsort(variance)[::-1]:
        if variance[k] < WIDE**2:
            break
        sentences.append(_direction(symbols, values, relative, vectors[:, k], float(variance[k])))
    own = dict(zip(symbols, np.sqrt(np.diagonal(relative)).tolist(), strict=True))
    for p in parameters:
        if p.sd <= 0.0 or p.symbol not in own:
            continue
        magnitude = p.sd / own[p.symbol]
        if p.value - p.low < AT_END * min(p.high - p.low, magnitude):
            sentences.append(
                f"{p.symbol} ended at its bound {p.low:g}: its data would rather have less"
            )
    return tuple(dict.fromkeys(sentences))


def _direction(
    symbols: Sequence[str],
    values: np.ndarray,
    relative: np.ndarray,
    vector: np.ndarray,
    variance: float,
) -> str:
    order = np.argsort(np.abs(vector))[::-1]
    # the wider the direction, the smaller a share in it still moves a parameter by WIDE
    share = float(np.clip(WIDE / np.sqrt(variance), 0.05, 0.25))
    carried = [int(k) for k in order if abs(vector[k]) > share]
    amount = f"±{100 * np.sqrt(variance):.0f} %" if variance < 25 else "any factor"
    if len(carried) == 1:
        return f"{symbols[carried[0]]} is not determined ({amount})"
    if len(carried) == 2:
        i, j = carried
        known, sd = _known_combination(symbols, values, relative, i, j)
        if sd < min(WIDE, 0.5 * np.sqrt(min(relative[i, i], relative[j, j]))):
            return (
                f"{symbols[i]} and {symbols[j]} run off together ({amount}): "
                f"only {known} is determined, to {100 * sd:.2g} %"
            )
    names = ", ".join(symbols[k] for k in carried[:-1]) + f" and {symbols[carried[-1]]}"
    return f"{names} trade against each other ({amount}): one number too many for these data"


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
