"""Intervals of a fit by several rules, and which of them stands in the card."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from sysid.data.loops import Loops
from sysid.identification.result import Fit
from sysid.uncertainty.covariance import grams_of, independent, sandwich
from sysid.uncertainty.error_model import ErrorModel, errors_at, errors_at_best
from sysid.uncertainty.estimate import Estimates
from sysid.uncertainty.propagated import by_eq_11, by_gls
from sysid.uncertainty.sample import observed_of

MOST: Final = 200
"""Tests whose Σ is sought: the work grows with their cube, and takes half a minute at so many."""


@dataclass(frozen=True)
class SideBySide:
    """Intervals by several rules.

    Attributes:
        card: Those that stand in the card and beside the values.
        beside: Those by other rules, for comparison.
        errors: Σ at the parameters that are most probable under it, where it was sought.
        because: Why the card's do not come from Σ; None where they do.
    """

    card: Estimates
    beside: tuple[Estimates, ...]
    errors: ErrorModel | None = None
    because: str | None = None

    @property
    def all(self) -> tuple[Estimates, ...]:
        """The card's first."""
        return (self.card, *self.beside)


def side_by_side(fit: Fit, loops: Loops) -> SideBySide:
    """All intervals of a fit.

    The card's are those of the fitted values under the errors that the campaign shows, of the rig
    and of the model's laws: they hold the truth as often as they say also where the laws are a
    little wrong (`benchmarks/coverage.py`).
    Where there is no such Σ, a sandwich takes its place.

    Args:
        fit: The fit.
        loops: Loops of its campaign; those that it used are looked at.
    """
    used = {t.id for t in fit.tests if t.used}
    own = loops.select(np.array([name in used for name in loops.ids], dtype=bool))
    grams = grams_of(fit)
    conditions, single = sandwich(fit, grams=grams), sandwich(fit, "tests", grams)
    plain = independent(fit, grams)
    rest = [conditions]
    for other in (single, plain):  # where there is nothing to leave out, all are the last
        if not any(np.array_equal(other.covariance, z.covariance, equal_nan=True) for z in rest):
            rest.append(other)
    because = _without(fit, own)
    if because is not None:
        return SideBySide(conditions, tuple(rest[1:]), None, because)
    observed = observed_of(fit, own)
    errors = errors_at(fit, observed)
    best = errors_at_best(fit, observed, errors)
    return SideBySide(by_eq_11(fit, own, errors), (by_gls(fit, best), *rest), best)


def _without(fit: Fit, own: Loops) -> str | None:
    """Why there is no Σ; None where there is."""
    if not own.ids or len(fit.problems) > 1:
        return (
            "Intervals come from a sandwich: the covariance of errors of rig and laws is one of "
            "steady sines, and other motion was fitted"
        )
    if len(own.ids) > MOST:
        return (
            f"Intervals come from a sandwich: the covariance of errors of rig and laws is sought "
            f"of at most {MOST} tests, and {len(own.ids)} were fitted"
        )
    return None
