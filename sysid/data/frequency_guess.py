"""First guesses of the frequency at which a record oscillates."""

import numpy as np
from jaxtyping import Float

from sysid.data.harmonics import fit_harmonics

Samples = Float[np.ndarray, " n"]

SHORT = 3.5
"""Cycles below which a spectrum is too coarse to give the frequency."""


def guess_frequencies(time: Samples, x: Samples, fewest: float) -> tuple[float, ...]:
    """Peaks of the spectrum, weighted by √f, f and f².

    A rest away from the centre has a 1/f spectrum, noise a flat one: no one weight suits both.

    Args:
        time: [n] s.
        x: [n] m.
        fewest: Samples a cycle that a guess must have at least.
    """
    n = time.size
    uniform = np.linspace(time[0], time[-1], n)
    y = np.interp(uniform, time, x)
    taper = np.hanning(n + 2)[1:-1]
    spectrum = np.abs(np.fft.rfft((y - np.mean(y)) * taper, 4 * n))
    f = np.fft.rfftfreq(4 * n, (time[-1] - time[0]) / (n - 1))
    possible = (f > 0.5 / (time[-1] - time[0])) & (f < f[-1] * 2.0 / fewest)
    if not np.any(possible):
        return ()
    guesses = {float(f[possible][np.argmax((spectrum * f**p)[possible])]) for p in (0.5, 1.0, 2.0)}
    if min(guesses) * (time[-1] - time[0]) < SHORT:
        guesses.add(_frequency_of_short(time, x))
    return tuple(sorted(guesses))


def _frequency_of_short(time: Samples, x: Samples) -> float:
    """The frequency of the sinusoid that fits a record of a few cycles best, as a whole."""
    from scipy.optimize import minimize_scalar

    duration = float(time[-1] - time[0])

    def misfit(frequency: float) -> float:
        fit = fit_harmonics(2.0 * np.pi * frequency * (time - time[0]), x, 1)
        return float(np.sum(fit.residual**2))

    grid = np.arange(0.6, SHORT, 0.05) / duration
    best = grid[int(np.argmin([misfit(f) for f in grid]))]
    bounds = (best - 0.1 / duration, best + 0.1 / duration)
    found = minimize_scalar(misfit, bounds=bounds, method="bounded")
    return float(getattr(found, "x"))  # noqa: B009 - the result's type has no stub
