"""Why stiffness scatters about its line: choice of points, noise, error of temperature."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.stats import chi2

from sysid.identification.straight_lines.lines import Line
from sysid.identification.straight_lines.stage import Reading

_TRIALS: Final = 160
"""Sizes of each part that are tried."""


@dataclass(frozen=True)
class ScatterSplit:
    """Parts of the scatter about the line, as standard deviations.

    In parts of the value, unless said otherwise.  An error of temperature moves every test by the
    same force per displacement, warm or cold; what the choice of points does goes with the value
    itself.  That, and nothing else, tells the two apart where both are unknown.

    Attributes:
        total: Of single tests about the lines, with the window that was used.
        choice: From the choice of points, seen by varying it: how much more or less than the other
            tests a test moves when all are read with another window.
        shared: How much all tests move together when the window is changed; it shifts the line
            and adds no scatter, unless the points are chosen anew in every test.
        noise: From the standard errors (repeated cycles).
        proportional: Most probable part in proportion to the value: choice of points, and
            whatever else goes with it.
        temperature: K, most probable error of temperature, or as it was told.
        temperature_interval: K, its 95 % interval from these tests, whatever was told.
        told: K, error of temperature as it was told; None where it was not.
        slope: Parts of the value per kelvin, at the test where it is largest.
        freedom: Degrees of freedom.
    """

    total: float
    choice: float
    shared: float
    noise: float
    proportional: float
    temperature: float
    temperature_interval: tuple[float, float]
    told: float | None
    slope: float
    freedom: int

    def beyond(self, line: Line) -> np.ndarray:
        """Standard deviation of [n] tests of a line beyond repetition, in units of the value."""
        value = line.at(line.temperature)[0]
        return np.hypot(self.proportional * value, self.temperature * line.slope)


@dataclass(frozen=True)
class _Level:
    """Tests of one current, about their unweighted line.

    Attributes:
        warm: [n] °C from the mean.
        read: [n] as read.
        value: [n] of the line.
        se: [n]
        rate: Of the line, per kelvin.
        windows: [n, windows] values with other windows, in parts of the value read, without their
            own lines.
        shared: See `ScatterSplit`.
    """

    warm: np.ndarray
    read: np.ndarray
    value: np.ndarray
    se: np.ndarray
    rate: float
    windows: np.ndarray
    shared: float


def split_scatter(
    levels: Sequence[tuple[float, Sequence[Reading]]], told: float | None = None
) -> ScatterSplit | None:
    """Split the scatter of a quantity about its lines, one a current.

    Args:
        levels: Current in A → its readings, each with the same windows.
        told: K, standard deviation of the temperatures, where it is known.

    Returns:
        None where fewer than two tests are beyond what the lines take up.
    """
    fits = [f for f in (_level(list(readings)) for _, readings in levels) if f is not None]
    freedom = sum(f.read.size - 2 for f in fits)
    if freedom < 2:
        return None
    proportional, temperature, interval = _most_probable(fits, told)
    lone = [f.windows - f.windows.mean(axis=1, keepdims=True) for f in fits]
    known = sum((z.shape[0] - 2) * (z.shape[1] - 1) for z in lone)
    off = np.concatenate([f.read / f.value - 1.0 for f in fits])
    return ScatterSplit(
        total=float(np.sqrt((off**2).sum() / freedom)),
        choice=float(np.sqrt(sum((z**2).sum() for z in lone) / known)),
        shared=float(np.mean([f.shared for f in fits])),
        noise=float(np.sqrt(np.mean(np.concatenate([(f.se / f.value) ** 2 for f in fits])))),
        proportional=proportional,
        temperature=temperature,
        temperature_interval=interval,
        told=told,
        slope=float(max(np.abs(f.rate / f.value).max() for f in fits)),
        freedom=freedom,
    )


def _most_probable(
    fits: Sequence[_Level], told: float | None
) -> tuple[float, float, tuple[float, float]]:
    """Sizes of both parts by restricted likelihood: variance se² + (c y)² + (s dy/dT)²."""
    steps = np.linspace(0.0, 1.0, _TRIALS) ** 2
    shares = 3.0 * max(float(np.abs(f.read / f.value - 1.0).max()) for f in fits) * steps
    kelvins = 3.0 * max(float(np.abs((f.read - f.value) / f.rate).max()) for f in fits) * steps
    cost = sum(_restricted(f, shares, kelvins) for f in fits)
    assert isinstance(cost, np.ndarray)
    profile = cost.min(axis=0)
    inside = kelvins[profile <= profile.min() + chi2.ppf(0.95, 1)]
    best = int(np.argmin(profile)) if told is None else int(np.argmin(np.abs(kelvins - told)))
    share = float(shares[np.argmin(cost[:, best])])
    kelvin = float(kelvins[best]) if told is None else told
    return share, kelvin, (float(inside[0]), float(inside[-1]))


def _restricted(f: _Level, shares: np.ndarray, kelvins: np.ndarray) -> np.ndarray:
    """−2 ln restricted likelihood of a line's residuals, [shares, kelvins]."""
    variance = (f.se**2 + (shares[:, None] * f.value) ** 2)[:, None, :]
    variance = variance + (kelvins[:, None] * f.rate) ** 2
    variance = np.maximum(variance, 1e-20 * f.value**2)
    weight, y = 1.0 / variance, f.read - f.value
    w, wx, wxx, wy, wxy, wyy = (
        weight @ z for z in (np.ones_like(y), f.warm, f.warm**2, y, f.warm * y, y**2)
    )
    det = w * wxx - wx**2
    explained = (wxx * wy**2 - 2.0 * wx * wy * wxy + w * wxy**2) / det
    return np.log(variance).sum(axis=2) + np.log(det) + wyy - explained


def _level(readings: list[Reading]) -> _Level | None:
    if len(readings) < 3:
        return None
    t = np.array([r.temperature for r in readings])
    choices = np.array([r.choices for r in readings])
    choices = choices[:, np.isfinite(choices).all(axis=0)]
    if np.ptp(t) <= 0.0 or choices.shape[1] < 2:
        return None
    read, se = np.array([(r.value, r.se) for r in readings]).T
    rows = np.stack([np.ones_like(t), t - t.mean()], axis=1)
    project = np.eye(t.size) - rows @ np.linalg.pinv(rows)
    ratio = choices / read[:, None]
    return _Level(
        warm=t - t.mean(),
        read=read,
        value=read - project @ read,
        se=np.where(np.isfinite(se), se, 0.0),
        rate=float(np.linalg.lstsq(rows, read, rcond=None)[0][1]),
        windows=project @ ratio,
        shared=float(ratio.mean(axis=0).std(ddof=1)),
    )
