"""`fit.json`: what a fit found, for scripts."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from sysid.cards.noise import mean_cycle_noise
from sysid.data.loops import Loops
from sysid.identification.result import Fit, TestError
from sysid.uncertainty.estimate import Estimates


def fit_json(
    fit: Fit, estimates: Estimates, loops: Loops, notes: Sequence[str] = ()
) -> dict[str, Any]:
    """A fit as the contract's object; unknown numbers are null.

    Args:
        fit: The fit.
        estimates: Its intervals, for what the data leave open.
        loops: Tests of the fit that are loops, for how well they repeat.
        notes: What was done on the way, one sentence each.
    """
    noise = mean_cycle_noise(loops)
    return {
        "schema": "sysid-fit-1",
        "model": fit.model,
        "variant": fit.variant,
        "weights": fit.weights,
        "result": fit.result.name,
        "message": fit.result.value,
        "tests": [test_json(t, noise) for t in sorted(fit.tests, key=lambda t: t.id)],
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


def test_json(test: TestError, noise: Mapping[str, float]) -> dict[str, Any]:
    """One test's entry.

    Args:
        test: Its error.
        noise: Test → noise of its mean cycle, N; those that are no loops are not in it.
    """
    return {
        "id": test.id,
        "rmse_N": known(test.rmse),
        "nrmse": known(test.nrmse),
        "fit_percent": known(test.fit_percent),
        "noise_floor_N": known(test.noise_floor),
        "mean_cycle_noise_N": known(noise.get(test.id)),
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
