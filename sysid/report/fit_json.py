"""`fit.json`: what a fit found, for scripts."""

import math
from collections.abc import Iterable, Sequence
from typing import Any

from sysid.identification.result import Fit, TestError
from sysid.uncertainty.estimate import Estimates


def fit_json(fit: Fit, estimates: Estimates, notes: Sequence[str] = ()) -> dict[str, Any]:
    """A fit as the contract's object; unknown numbers are null.

    Args:
        fit: The fit.
        estimates: Its intervals, for what the data leave open.
        notes: What was done on the way, one sentence each.
    """
    return {
        "schema": "sysid-fit-1",
        "model": fit.model,
        "variant": fit.variant,
        "weights": fit.weights,
        "result": fit.result.name,
        "message": fit.result.value,
        "tests": [test_json(t) for t in sorted(fit.tests, key=lambda t: t.id)],
        "summary": {
            "mean_nrmse": known(fit.mean_nrmse),
            "held_out_mean_nrmse": known(fit.held_out_mean_nrmse),
            "cost": known(fit.cost),
            "starts": fit.starts,
            "basins": len(fit.basins),
        },
        "basins": [{"cost": b.cost, "hits": b.hits} for b in fit.basins],
        "undetermined": list(estimates.undetermined),
        "notes": [*fit.notes, *notes],
    }


def test_json(test: TestError) -> dict[str, Any]:
    """One test's entry."""
    return {
        "id": test.id,
        "rmse_N": known(test.rmse),
        "nrmse": known(test.nrmse),
        "fit_percent": known(test.fit_percent),
        "noise_floor_N": known(test.noise_floor),
        "held_out": test.held_out,
        "used": test.used,
        "why_not": test.why_not,
    }


def mean(values: Iterable[float]) -> float | None:
    """Mean of the finite ones among some numbers, None without any."""
    finite = [v for v in values if math.isfinite(v)]
    return sum(finite) / len(finite) if finite else None


def known(value: float | None) -> float | None:
    """A finite number, or None."""
    return None if value is None or not math.isfinite(value) else float(value)
