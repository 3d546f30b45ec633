"""Which parameters, and which combinations of them, the data do not determine, in words."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from sysid.uncertainty.estimate import Estimate

WIDE: Final = 0.5
"""Relative standard deviation above which a direction is left open."""
ANY: Final = 25.0
"""Relative variance from which a direction reaches any factor."""
NUMBERS: Final = ("no", "one", "two", "three", "four", "five")
AT_END: Final = 1e-3
"""Part of its interval, or of its magnitude where that is smaller, that a value which ended at a
bound is off it: solvers only come near."""


@dataclass(frozen=True)
class _Group:
    """Wide directions of the same parameters.

    Attributes:
        carried: Places of the parameters that they move, the widest direction's first.
        variances: Of each direction, widest first.
    """

    carried: tuple[int, ...]
    variances: tuple[float, ...]

    def joined(self, other: "_Group") -> "_Group":
        """With a direction that is less wide."""
        carried = tuple(dict.fromkeys((*self.carried, *other.carried)))
        return _Group(carried, self.variances + other.variances)

    def words(self, symbols: Sequence[str]) -> str:
        """How many numbers these parameters are too many for the data."""
        names = [symbols[k] for k in self.carried]
        listed = names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
        count, amount = len(self.variances), _amount(self.variances)
        if count >= len(names):
            return f"{listed} {'is' if len(names) == 1 else 'are'} not determined ({amount})"
        many = NUMBERS[count] if count < len(NUMBERS) else str(count)
        return (
            f"{listed} trade against each other ({amount}): {many} "
            f"number{'s' * (count > 1)} too many for these data"
        )


def undetermined(
    symbols: Sequence[str],
    values: np.ndarray,
    relative: np.ndarray,
    parameters: Sequence[Estimate],
) -> tuple[str, ...]:
    """Sentences about what the data leave open.

    Directions are eigenvectors of the covariance of relative changes.  A wide direction that two
    parameters share is said as the product or the ratio of them that remains known.  Others that
    move the same parameters are told together: eigenvectors mix what is alike wide.

    Args:
        symbols: [n] free parameters.
        values: [n].
        relative: [n, n] covariance of changes relative to the parameters' magnitudes.
        parameters: Estimates; free ones at a bound are mentioned.
    """
    variance, vectors = np.linalg.eigh(relative)
    sentences: list[str | _Group] = []
    for k in np.argsort(variance)[::-1]:
        if variance[k] < WIDE**2:
            break
        wide = _Group(_carried(vectors[:, k], float(variance[k])), (float(variance[k]),))
        known = _only_known(symbols, values, relative, wide)
        if known is None:
            sentences = _with_group(sentences, wide)
        else:
            sentences.append(known)
    told = [one.words(symbols) if isinstance(one, _Group) else one for one in sentences]
    own = dict(zip(symbols, np.sqrt(np.diagonal(relative)).tolist(), strict=True))
    for p in parameters:
        if p.sd <= 0.0 or p.symbol not in own:
            continue
        magnitude = p.sd / own[p.symbol]
        if p.value - p.low < AT_END * min(p.high - p.low, magnitude):
            told.append(f"{p.symbol} ended at its bound {p.low:g}: its data would rather have less")
    return tuple(dict.fromkeys(told))


def _carried(vector: np.ndarray, variance: float) -> tuple[int, ...]:
    """Parameters that a direction moves, most first."""
    # the wider the direction, the smaller a share in it still moves a parameter by WIDE
    share = float(np.clip(WIDE / np.sqrt(variance), 0.05, 0.25))
    return tuple(int(k) for k in np.argsort(np.abs(vector))[::-1] if abs(vector[k]) > share)


def _with_group(told: Sequence[str | _Group], wide: _Group) -> list[str | _Group]:
    """Joined with all groups that move one of its parameters, where the first of them stands."""
    apart: list[str | _Group] = []
    place, whole = len(told), None
    for one in told:
        if isinstance(one, _Group) and set(one.carried) & set(wide.carried):
            place = min(place, len(apart))
            whole = one if whole is None else whole.joined(one)
        else:
            apart.append(one)
    apart.insert(place, wide if whole is None else whole.joined(wide))
    return apart


def _amount(variances: Sequence[float]) -> str:
    """How far directions reach, widest first."""
    least = f"±{100 * np.sqrt(variances[-1]):.0f} %"
    if variances[-1] >= ANY:
        return "any factor"
    return least if len(variances) == 1 else f"{least} and more"


def _only_known(
    symbols: Sequence[str], values: np.ndarray, relative: np.ndarray, wide: _Group
) -> str | None:
    """What of two parameters that run off together is known; None where that is nothing."""
    if len(wide.carried) != 2:
        return None
    i, j = wide.carried
    known, sd = _known_combination(symbols, values, relative, i, j)
    if sd >= min(WIDE, 0.5 * np.sqrt(min(relative[i, i], relative[j, j]))):
        return None
    return (
        f"{symbols[i]} and {symbols[j]} run off together ({_amount(wide.variances)}): "
        f"only {known} is determined, to {100 * sd:.2g} %"
    )


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
