"""How well REML tells how large errors of the model's laws are, and what its kernel has to do.

Campaigns as in `coverage.py`, with laws that leave 2 %.  The virtual rig draws relative errors of
the laws of one size ε from a squared exponential.  Σ gives half of their variance to one three
times as smooth, so that a trend is not taken for an effect, and tries lengths in steps of √2.
Sizes are told with that and with the rig's own kernel: over ε, and how far REML says that they may
be off.
"""

import os
from dataclasses import replace
from typing import Final

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from interval_campaign import fitted
from outcome import Outcome, arguments
from place_of_covariance import rig_kernel

from sysid.likelihood.discrepancy import NAMES, Sizes
from sysid.likelihood.reml import fit_sizes
from sysid.uncertainty.error_model import errors_at, errors_at_best
from sysid.uncertainty.sample import observed_of

CAMPAIGNS: Final = 20
FIRST_SEED: Final = 61_000_000
PERCENT: Final = 2.0
LAWS: Final = ("scale", "width", "growth")
"""Of the model; the rig does not err in the steepness."""
UNIT: Final = np.array([np.sqrt(2.0), 1.0, 1.0])
"""Sizes for an ε of one: the force errs in F_t and in C_i, and both scale it."""
KERNELS: Final = ("by REML, half of the variance of a trend", "the rig's own")


def one(seed: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Logarithms of sizes over ε, and REML's standard deviations of them, for each kernel."""
    trial, fit, design = fitted(seed, PERCENT)
    observed = observed_of(fit, trial.loops)
    best = errors_at_best(fit, observed, errors_at(fit, observed))
    parts = replace(best.observed.parts, kernel=rig_kernel(trial.loops))
    residual, jacobian = best.observed.look(fit.coordinates, best.u)
    known = fit_sizes(parts, residual, jacobian, best.sizes, times=np.inf)
    return [_told(z.sizes, z.spread, design.misfit) for z in (best, known)]


def _told(sizes: Sizes, spread: np.ndarray | None, error: float) -> tuple[np.ndarray, np.ndarray]:
    assert spread is not None
    ratio = np.array([getattr(sizes, name) for name in LAWS]) / (UNIT * error)
    return np.log(ratio), spread[[NAMES.index(name) for name in LAWS]]


def main() -> None:
    campaigns, quick = arguments(__doc__ or "", CAMPAIGNS, 1)
    rows = []
    for seed in range(FIRST_SEED, FIRST_SEED + campaigns):
        rows.append(one(seed))
        print(f"campaign {seed}: done", flush=True)
    found = np.array(rows)  # [campaign, kernel, told, law]
    outcome = Outcome("law_sizes", "Sizes of errors of the laws by REML")
    outcome.say(
        f"{campaigns} campaigns of `coverage.py` whose laws leave {PERCENT:g} %.  Sizes over those",
        "that the virtual rig drew errors of the laws with.",
    )
    table = []
    for k, kernel in enumerate(KERNELS):
        for j, law in enumerate(LAWS):
            ln, told = found[:, k, 0, j], float(np.mean(found[:, k, 1, j]))
            ratio, scatter = float(np.exp(ln.mean())), float(ln.std(ddof=1))
            table.append((kernel, law, f"{ratio:.2f}", f"{scatter:.2f}", f"{told:.2f}"))
            outcome.numbers[f"{law}, {kernel}"] = {
                "ratio": ratio, "scatter_ln": scatter, "told_ln": told,
            }  # fmt: skip
    outcome.table(
        ("kernel", "law", "size over the rig's, geometric mean", "scatter of its logarithm",
         "as REML tells it"), table,
    )  # fmt: skip
    outcome.finish(keep=not quick)


if __name__ == "__main__":
    main()
