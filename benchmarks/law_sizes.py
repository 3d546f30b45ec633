"""How well REML tells how large errors of the model's laws are, and what its kernel has to do.

Campaigns as in `coverage.py` and `lumped_coverage.py`, with laws that leave about 2 %.  The rigs
draw relative errors of the laws of one size ε from a squared exponential.  Σ gives half of their
variance to one three times as smooth, so that a trend is not taken for an effect, and tries lengths
in steps of √2.  Sizes are told with that and with the rig's own kernel: over ε, and how far REML
says that they may be off.  Then what it comes to: standard deviations of parameters over those by
the rig's own Σ, and how often intervals would hold the truth if errors were drawn from that.
"""

import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from interval_campaign import fitted
from jaxtyping import Float
from outcome import Outcome, arguments
from place_of_covariance import TINY, rig_kernel
from scipy.special import ndtr

from sysid.data.loops import Loops
from sysid.identification.result import Fit
from sysid.likelihood.discrepancy import NAMES, Sizes
from sysid.likelihood.plausible import Plausible
from sysid.likelihood.reml import fit_sizes
from sysid.uncertainty.covariance import OPEN
from sysid.uncertainty.error_model import ErrorModel, errors_at, errors_at_best
from sysid.uncertainty.estimate import Estimates
from sysid.uncertainty.propagated import by_eq_11
from sysid.uncertainty.sample import observed_of

CAMPAIGNS: Final = 20
PERCENT: Final = 2.0
LUMPED_ERROR: Final = 0.092
"""ε at which the refitted lumped model leaves about `PERCENT` (`lumped_coverage.py`)."""
LAWS: Final = ("scale", "width", "growth")
"""Of the model; the rig does not err in the steepness."""
KERNELS: Final = ("by REML, half of the variance of a trend", "the rig's own")


@dataclass(frozen=True)
class Wrong:
    """A campaign of a damper whose laws err.

    Attributes:
        loops: As a rig gives them.
        fit: By least squares.
        error: ε.
        unit: Sizes of `LAWS` for an ε of one.
        kernel: Of the rig's errors between tests, for a variance of one.
        rig: Sizes of what varies from test to test there.
    """

    loops: Loops
    fit: Fit
    error: float
    unit: Float[np.ndarray, " law"]
    kernel: Float[np.ndarray, "loop loop"]
    rig: Sizes

    @property
    def sizes(self) -> Sizes:
        """Of the rig's own Σ."""
        laws = dict(zip(LAWS, (self.unit * self.error).tolist(), strict=True))
        return replace(self.rig, **laws)


def generalized(seed: int) -> Wrong:
    """A campaign of `coverage.py`."""
    trial, fit, design = fitted(61_000_000 + seed, PERCENT)
    unit = np.array([np.sqrt(2.0), 1.0, 1.0])  # the force errs in F_t and in C_i: both scale it
    rig = Sizes(gain=6e-3, offset=2.0, delay=1e-4)
    return Wrong(trial.loops, fit, design.misfit, unit, rig_kernel(trial.loops), rig)


def lumped(seed: int) -> Wrong:
    """One of `lumped_coverage.py`."""
    from lumped_campaign import CURRENTS, noisy_loops, sweep
    from lumped_coverage import (
        DELAY,
        GAIN,
        NOISE,
        OFFSET,
        SMOOTH,
        TEMPERATURES,
        THERMOMETER,
        departure,
        place_of,
    )

    from sysid.identification.fit import fit_loops

    tests, laws = sweep(CURRENTS, TEMPERATURES), departure(63_000_000 + seed)
    loops, _ = noisy_loops(
        tests, np.random.default_rng([63_000_000 + seed, 2]), noise=NOISE, offset=OFFSET, gain=GAIN,
        delay=DELAY, temperature=THERMOMETER, made=lambda felt: laws.loops(felt, LUMPED_ERROR),
    )  # fmt: skip
    place = place_of(tests) / SMOOTH
    kernel = np.exp(-0.5 * np.sum((place[:, None] - place[None]) ** 2, axis=2))
    return Wrong(
        loops, fit_loops(loops, model="lumped", max_waves=1), LUMPED_ERROR, np.ones(3),
        kernel + TINY * np.eye(len(kernel)),
        Sizes(gain=GAIN, offset=OFFSET, delay=DELAY, thermometer=THERMOMETER),
    )  # fmt: skip


MODELS: Final[dict[str, Callable[[int], Wrong]]] = {
    "generalised model": generalized,
    "BS09's model": lumped,
}


@dataclass(frozen=True)
class Found:
    """What Σ says of one campaign.

    Attributes:
        ln: [kernel, law] logarithm of size over the rig's.
        told: [kernel, law] its standard deviation by REML.
        deviation: Symbol → ln of the standard deviation over that by the rig's own Σ, of
            parameters that this identifies.
        holds: Symbol → probability that the interval holds the truth, if errors are drawn from it.
    """

    ln: Float[np.ndarray, "2 law"]
    told: Float[np.ndarray, "2 law"]
    deviation: dict[str, float]
    holds: dict[str, float]


def found(wrong: Wrong) -> Found:
    """Sizes with both kernels, and the card's intervals to first order beside the rig's own."""
    fit, loops = wrong.fit, wrong.loops
    observed = observed_of(fit, loops)
    at = errors_at(fit, observed)
    best = errors_at_best(fit, observed, at)
    parts = replace(best.observed.parts, kernel=wrong.kernel)
    residual, jacobian = best.observed.look(fit.coordinates, best.u)
    known = fit_sizes(parts, residual, jacobian, best.sizes, times=np.inf)
    both = [_told(z.sizes, z.spread, wrong) for z in (best, known)]
    own = Plausible(1.0, at.observed.parts.lengths, wrong.kernel, wrong.sizes)
    card, true = (_straight(wrong, e) for e in (at, replace(at, plausible=(own,))))
    size = {p.symbol: abs(p.value) for p in card.parameters}
    sd = {p.symbol: p.sd for p in true.parameters if 0.0 < p.sd <= OPEN * size[p.symbol]}
    here = {p.symbol: p for p in card.parameters if p.symbol in sd}
    return Found(
        np.array([ln for ln, _ in both]),
        np.array([spread for _, spread in both]),
        {s: float(np.log(p.sd / sd[s])) for s, p in here.items()},
        {s: float(2.0 * ndtr(0.5 * (p.high - p.low) / sd[s]) - 1.0) for s, p in here.items()},
    )


def _straight(wrong: Wrong, errors: ErrorModel) -> Estimates:
    return by_eq_11(wrong.fit, wrong.loops, errors, bent=False)


def _told(sizes: Sizes, spread: np.ndarray | None, wrong: Wrong) -> tuple[np.ndarray, np.ndarray]:
    assert spread is not None
    ratio = np.array([getattr(sizes, name) for name in LAWS]) / (wrong.unit * wrong.error)
    return np.log(ratio), spread[[NAMES.index(name) for name in LAWS]]


def main() -> None:
    campaigns, quick = arguments(__doc__ or "", CAMPAIGNS, 2)
    outcome = Outcome("law_sizes", "Sizes of errors of the laws by REML")
    outcome.say(
        f"{campaigns} campaigns of `coverage.py` and of `lumped_coverage.py` each, whose laws",
        f"leave {PERCENT:g} %.  Sizes over those that the virtual rig drew errors of the laws",
        "with.",
    )
    for model, made in MODELS.items():
        rows = []
        for seed in range(campaigns):
            rows.append(found(made(seed)))
            print(f"{model}, campaign {seed}: done", flush=True)
        say(outcome, model, rows)
    outcome.finish(keep=not quick)


def say(outcome: Outcome, model: str, rows: list[Found]) -> None:
    """A model's part of the page."""
    outcome.say(f"## {model}")
    table, numbers = [], {}
    for k, kernel in enumerate(KERNELS):
        for j, law in enumerate(LAWS):
            ln, told = (np.array([getattr(r, z)[k, j] for r in rows]) for z in ("ln", "told"))
            ratio, scatter = float(np.exp(ln.mean())), float(ln.std(ddof=1))
            table.append((kernel, law, f"{ratio:.2f}", f"{scatter:.2f}", f"{told.mean():.2f}"))
            numbers[f"{law}, {kernel}"] = {
                "ratio": ratio, "scatter_ln": scatter, "told_ln": float(told.mean()),
            }  # fmt: skip
    outcome.table(
        ("kernel", "law", "size over the rig's, geometric mean", "scatter of its logarithm",
         "as REML tells it"), table,
    )  # fmt: skip
    symbols = [s for s in rows[0].deviation if all(s in r.deviation for r in rows)]
    ln = np.array([[r.deviation[s] for s in symbols] for r in rows])
    holds = np.array([[r.holds[s] for s in symbols] for r in rows])
    scatter = float(np.median(ln.std(axis=0, ddof=1)))
    least, most = (int(z) for z in (holds.mean(axis=0).argmin(), holds.mean(axis=0).argmax()))
    outcome.say(
        f"Standard deviations of the {len(symbols)} parameters that the rig's own Σ identifies in",
        "all of them: over those by it, geometric mean",
        f"{np.exp(ln.mean()):.2f}, scatter of the logarithm {scatter:.2f} (median of parameters).",
        "If errors were drawn from that, the card's intervals (to first order) would hold",
        f"{holds.mean():.1%} of the true values: from {holds[:, least].mean():.1%} of",
        f"{symbols[least]} to {holds[:, most].mean():.1%} of {symbols[most]}.",
    )
    numbers["parameters"] = {
        "ratio": float(np.exp(ln.mean())), "scatter_ln": scatter, "holds": float(holds.mean()),
        "by_symbol": dict(zip(symbols, holds.mean(axis=0).tolist(), strict=True)),
    }  # fmt: skip
    outcome.numbers[model] = numbers


if __name__ == "__main__":
    main()
