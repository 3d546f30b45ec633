"""Have the chains converged: traces of the ensembles, and how long they remember."""

from typing import Final

import numpy as np
from emcee.autocorr import function_1d
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sysid.report.figure import new_axes, png
from sysid.uncertainty.posterior import Posterior

MOST_STEPS: Final = 500
COLOURS: Final = ("tab:blue", "tab:orange", "tab:green", "tab:red")
LAGS: Final = 6.0
"""Autocorrelation times that are shown."""


def plot_trace(draws: Float[np.ndarray, "chain step walker"], *, ax: Axes | None = None) -> Axes:
    """Mean of each ensemble over its walkers, within the band of nine tenths of them.

    Args:
        draws: Of one parameter.
        ax: Where to draw.
    """
    ax = new_axes(ax)
    every = max(1, draws.shape[1] // MOST_STEPS)
    steps = np.arange(draws.shape[1])[::every]
    for k, chain in enumerate(draws[:, ::every]):
        low, high = np.quantile(chain, [0.05, 0.95], axis=1)
        colour = COLOURS[k % len(COLOURS)]
        ax.fill_between(steps, low, high, color=colour, alpha=0.12, linewidth=0)
        ax.plot(steps, chain.mean(axis=1), color=colour, linewidth=0.8)
    ax.set_xlim(0, draws.shape[1])
    ax.grid(alpha=0.3)
    return ax


def plot_autocorrelation(
    draws: Float[np.ndarray, "chain step walker"], tau: float, *, ax: Axes | None = None
) -> Axes:
    """Autocorrelation of each ensemble, mean over its walkers, and its time τ.

    Args:
        draws: Of one parameter.
        tau: Steps.
        ax: Where to draw.
    """
    ax = new_axes(ax)
    lags = int(np.clip(LAGS * tau, 10, draws.shape[1] - 1))
    for k, chain in enumerate(draws):
        moving = chain.T[np.ptp(chain, axis=0) > 0.0]
        memory = np.mean([function_1d(walker)[:lags] for walker in moving], axis=0)
        ax.plot(memory, color=COLOURS[k % len(COLOURS)], linewidth=1.0)
    ax.axvline(min(tau, lags), color="black", linestyle=":", linewidth=1.0)
    ax.axhline(0.0, color="0.6", linewidth=0.8)
    ax.set_xlim(0, lags)
    ax.set_ylim(-0.15, 1.0)
    ax.grid(alpha=0.3)
    return ax


def trace_png(posterior: Posterior) -> bytes:
    """Trace and autocorrelation of every free parameter, a row each."""
    walkers, evidence = posterior.by_walker, posterior.convergence
    count = len(posterior.symbols)
    figure = Figure(figsize=(11.0, 1.3 * count + 1.2), layout="constrained")
    axes = figure.subplots(count, 2, squeeze=False, width_ratios=(3.0, 1.0))
    for k, spec in enumerate(posterior.declared):
        left = plot_trace(walkers[..., k], ax=axes[k, 0])
        unit = "" if spec.unit == "-" else f" / {spec.unit}"
        left.set_ylabel(f"{spec.symbol}{unit}", fontsize=9)
        right = plot_autocorrelation(walkers[..., k], float(evidence.tau[k]), ax=axes[k, 1])
        right.set_title(
            f"τ {evidence.tau[k]:.0f}, R̂ {evidence.rhat[k]:.3f}, "
            f"ESS {evidence.bulk[k]:.0f}, tails {evidence.tail[k]:.0f}",
            fontsize=8,
        )
        if k < count - 1:
            left.tick_params(labelbottom=False)
    axes[0, 0].set_title(
        f"Four ensembles of {posterior.walkers} walkers: means, and nine tenths of the walkers "
        f"({posterior.message})",
        fontsize=9,
    )
    axes[-1, 0].set_xlabel("step")
    axes[-1, 1].set_xlabel("lag in steps")
    return png(figure, dpi=80)
