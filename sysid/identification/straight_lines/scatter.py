"""Why stiffness scatters about its line: choice of points, noise, error of temperature."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from sysid.identification.straight_lines.lines import slope_of
from sysid.identification.straight_lines.stage import Reading


@dataclass(frozen=True)
class ScatterSplit:
    """Parts of the scatter about the line, as standard deviations.

    Parts of the value, unless said otherwise; `total`² ≈ `choice`² + `noise`² + `rest`².

    Attributes:
        total: Of single tests about the lines, with the window that was used.
        choice: From the choice of points: how much more or less than the other tests a test
            moves when all are read with another window.
        shared: How much all tests move together when the window is changed; it shifts the line
            and adds no scatter, unless the points are chosen anew in every test.
        noise: From the standard errors (repeated cycles).
        rest: What neither explains.
        temperature: K, error of temperature that would make the rest.
        temperature_interval: K, its 95 % interval.
        told: K, error of temperature as it was told; None where it was not.
        unexplained: What is left beyond choice, noise and the told error; None likewise.
        slope: Parts of the value per kelvin at the coldest test.
        freedom: Degrees of freedom.
    """

    total: float
    choice: float
    shared: float
    noise: float
    rest: float
    temperature: float
    temperature_interval: tuple[float, float]
    told: float | None
    unexplained: float | None
    slope: float
    freedom: int


def split_scatter(
    levels: Sequence[tuple[float, Sequence[Reading]]], told: float | None = None
) -> ScatterSplit | None:
    """Split the scatter of a quantity about its lines, one a current.

    Every window gives each test a residual about that window's own line.  A wrong temperature
    moves a test's residuals alike whatever the window; the choice of points does not.  So the mean
    over windows holds temperature and noise, and the rest of each residual the choice of points.

    Args:
        levels: Current in A → its readings, each with the same windows.
        told: K, standard deviation of the temperatures, where it is known.

    Returns:
        None where fewer than two tests are beyond what the lines take up.
    """
    fits = [_residuals(list(readings)) for _, readings in levels]
    known = [f for f in fits if f is not None]
    freedom = sum(f.own.size - 2 for f in known)
    if freedom < 2:
        return None
    own, value, se, slope = (
        np.concatenate([getattr(f, name) for f in known]) for name in ("own", "value", "se", "rate")
    )
    windows = min(f.residual.shape[1] for f in known)
    residual = np.concatenate([f.residual[:, :windows] for f in known])
    common = residual.mean(axis=1)
    lone = residual - common[:, None]
    noise = float(np.nanmean(se**2)) if np.isfinite(se).any() else 0.0
    square = float((common**2).sum())
    between = max(square / freedom - noise, 0.0)
    bounds = (square / chi2.ppf(q, freedom) - noise for q in (0.975, 0.025))
    per_kelvin = float((slope**2).mean())
    low, high = (float(np.sqrt(max(b, 0.0) / per_kelvin)) for b in bounds)
    unexplained = None
    if told is not None:
        unexplained = float(np.sqrt(max(between - told**2 * per_kelvin, 0.0) / (value**2).mean()))
    relative = lone / value[:, None]
    return ScatterSplit(
        total=float(np.sqrt(((own / value) ** 2).sum() / freedom)),
        choice=float(np.sqrt((relative**2).sum() / (freedom * max(windows - 1, 1)))),
        shared=float(np.mean([f.shared for f in known])),
        noise=float(np.sqrt(np.nanmean((se / value) ** 2))) if noise > 0.0 else 0.0,
        rest=float(np.sqrt(between / (value**2).mean())),
        temperature=float(np.sqrt(between / per_kelvin)),
        temperature_interval=(low, high),
        told=told,
        unexplained=unexplained,
        slope=float(np.abs(slope / value).max()),
        freedom=freedom,
    )


@dataclass(frozen=True)
class _Residuals:
    own: np.ndarray
    residual: np.ndarray
    value: np.ndarray
    se: np.ndarray
    rate: np.ndarray
    shared: float


def _residuals(readings: list[Reading]) -> _Residuals | None:
    """Residuals about the unweighted line of one current, for the window used and all others."""
    if len(readings) < 3:
        return None
    t = np.array([r.temperature for r in readings])
    if np.ptp(t) <= 0.0:
        return None
    value = np.array([r.value for r in readings])
    choices = np.array([r.choices for r in readings])
    choices = choices[:, np.isfinite(choices).all(axis=0)]
    if choices.shape[1] < 2:
        return None
    rows = np.stack([np.ones_like(t), t - t.mean()], axis=1)
    project = np.eye(t.size) - rows @ np.linalg.pinv(rows)
    return _Residuals(
        own=project @ value,
        residual=project @ choices,
        value=value - project @ value,
        se=np.array([r.se for r in readings]),
        rate=np.full(t.size, slope_of(t, value)),
        shared=float((choices / value[:, None]).mean(axis=0).std(ddof=1)),
    )
