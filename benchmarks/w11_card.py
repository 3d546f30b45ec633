"""One W11 card for both columns of its Table 2, some of whose parameters differ between the sets.

Fitted to the tests without noise, so that every error is that of the card.
"""

import itertools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float
from scipy.optimize import least_squares

from sysid.effects.law.width_law import WidthLaw
from sysid.models.damper import Damper
from sysid.models.generalized import HIGH_SYMMETRIC, LOW_SYMMETRIC, Generalized
from sysid.motion.motion import Motion, sine_motion

LAWS: Final = {
    "plateau over speed, F_t": ("F_0", "a_1"),
    "gain over current, C_i": ("I_0", "a_2", "k_2"),
    "steepness, a": ("a_0", "k_0"),
    "loop width, v_h": ("k_4", "k_3", "a_3", "I_1"),
    "rise beyond the step, k_v": ("k_1c", "a_4"),
}
SYMBOLS: Final = tuple(itertools.chain(*LAWS.values()))
SIGNED: Final = ("I_0", "I_1", "k_4")
"""Parameters that differ by a term; all others differ by a factor."""
CONDITIONS: Final = (
    *((12.5e-3, f) for f in (0.5, 1.5, 2.5, 5.0)),
    *((2.5e-3, f) for f in (5.0, 7.5, 10.0, 12.5, 15.0)),
)
CURRENTS: Final = (0.0, 0.1, 0.2, 0.3, 0.4)
POINTS: Final = 120
STARTS: Final = 4
Freed = frozenset[str]
"""Symbols whose values differ between the sets; `WIDTH` for the exponent of the effect."""
WIDTH: Final = "p_w"
HELD: Final = 1e-4
"""Weight by which coordinates are held near the start."""
BEST: Final = 2
"""Sets of freed parameters of each size from which the next larger ones are built."""


@dataclass(frozen=True)
class Fitted:
    """A card fitted to all tests, or to some.

    Attributes:
        u: [13 + 13 + 1]: base parameters, differences of the 2.5 mm set from them, p_w.
        error: [L] RMSE/max|F|.
    """

    u: Float[np.ndarray, " n"]
    error: Float[np.ndarray, " loop"]

    @property
    def mean(self) -> float:
        """Of all tests."""
        return float(self.error.mean())


@cache
def campaign() -> tuple[Motion, Bool[np.ndarray, " loop"]]:
    """Motion of all tests, and which of them are of 2.5 mm."""
    amplitude, frequency = np.repeat(np.array(CONDITIONS), len(CURRENTS), axis=0).T
    current = np.tile(CURRENTS, len(CONDITIONS))
    return sine_motion(amplitude, frequency, current, points=POINTS), amplitude < 5e-3


def card(u: Float[Array, " n"]) -> Damper:
    """One damper whose base parameters are of the one or of the other set, test by test."""
    n, high = len(SYMBOLS), jnp.asarray(campaign()[1], float)[:, None]
    values = {}
    for k, symbol in enumerate(SYMBOLS):
        here = u[k] + high * u[n + k]
        values[symbol] = here if symbol in SIGNED else jnp.exp(here)
    zero = jnp.zeros(())
    values |= {"k_1e": values["k_1c"], "k_5": zero, "k_6": zero}
    return Damper(Generalized(**values), (WidthLaw(u[-1], part="yield"),))


def column(values: Mapping[str, float]) -> np.ndarray:
    """A column of Table 2 as coordinates, [13]."""
    return np.array([values[s] if s in SIGNED else np.log(values[s]) for s in SYMBOLS])


def both() -> np.ndarray:
    """Both columns as they are, [27]."""
    low, high = column(LOW_SYMMETRIC), column(HIGH_SYMMETRIC)
    return np.array([*low, *(high - low), 0.0])


@cache
def truth() -> tuple[np.ndarray, np.ndarray]:
    """Force of each set by its own column, [L, J], and its peaks, [L, 1]."""
    force = np.asarray(card(jnp.asarray(both())).force(campaign()[0]))
    return force, np.abs(force).max(axis=1, keepdims=True)


@eqx.filter_jit
def _residual(u: Float[Array, " n"]) -> Float[Array, "loop point"]:
    force, peak = truth()
    return (card(u).force(campaign()[0]) - force) / peak / jnp.sqrt(POINTS)


_slopes = eqx.filter_jit(jax.jacfwd(_residual))


def fit(
    freed: Iterable[str], starts: Iterable[np.ndarray] = (), kept: np.ndarray | None = None
) -> Fitted:
    """Least squares with weights 1/max|F|, the best of several starts.

    Args:
        freed: Symbols that differ between the sets, and `WIDTH`.
        starts: To begin at; if none, on the way from one column to the other.
        kept: [L] tests that are fitted; all if not given.
    """
    truth()  # before anything is compiled
    n, chosen = len(SYMBOLS), frozenset(freed)
    free = np.array([True] * n + [s in chosen for s in SYMBOLS] + [WIDTH in chosen])
    rows = np.ones(len(campaign()[1]), bool) if kept is None else kept
    low, high = column(LOW_SYMMETRIC), column(HIGH_SYMMETRIC)
    along = [low + z * (high - low) for z in np.linspace(0.0, 1.0, STARTS)]
    first = list(starts) or [np.array([*z, *np.zeros(n), 0.3]) for z in along]
    found = [_from(np.where(free, start, 0.0), free, rows) for start in first]
    u = min(found, key=lambda f: f[0])[1]
    return Fitted(u, np.sqrt((np.asarray(_residual(jnp.asarray(u))) ** 2).sum(axis=1)))


def _from(
    start: np.ndarray, free: np.ndarray, rows: np.ndarray
) -> tuple[float, Float[np.ndarray, " n"]]:
    """Cost and place of the optimum that a start leads to.

    Coordinates that hardly matter are held near the start, so weakly that no error changes.
    """

    def whole(z: np.ndarray) -> np.ndarray:
        u = start.copy()
        u[free] = z
        return u

    def residual(z: np.ndarray) -> np.ndarray:
        r = np.asarray(_residual(jnp.asarray(whole(z))))[rows].ravel()
        return np.concatenate([r, HELD * (z - start[free])])

    def slopes(z: np.ndarray) -> np.ndarray:
        s = np.asarray(_slopes(jnp.asarray(whole(z))))[rows].reshape(-1, start.size)[:, free]
        return np.concatenate([s, HELD * np.eye(z.size)])

    solved = least_squares(residual, start[free], slopes, x_scale="jac", max_nfev=150)  # pyright: ignore[reportArgumentType]  # jac may be a function
    return float(solved.cost), whole(solved.x)


def held_out(freed: Freed, fitted: Fitted) -> float:
    """Mean error, every condition predicted by the card that was fitted without it."""
    number = np.repeat(np.arange(len(CONDITIONS)), len(CURRENTS))
    errors = [
        fit(freed, [fitted.u], number != k).error[number == k] for k in range(len(CONDITIONS))
    ]
    return float(np.concatenate(errors).mean())


def fewest() -> list[tuple[Freed, Fitted]]:
    """The smallest error with 0, 1, 2, … parameters that differ; none of them the effect.

    Forward from none, a few of each number going on, and backward from all; the better of both.
    """
    forward = {frozenset(): fit(())}
    best = {0: (frozenset[str](), forward[frozenset()])}
    for count in range(1, len(SYMBOLS)):
        larger: dict[Freed, Fitted] = {}
        for have, fitted in forward.items():
            for symbol in SYMBOLS:
                wanted = have | {symbol}
                if symbol not in have and wanted not in larger:
                    larger[wanted] = fit(wanted, [fitted.u])
        ranked = sorted(larger.items(), key=lambda item: item[1].mean)
        forward, best[count] = dict(ranked[:BEST]), ranked[0]
    have = frozenset(SYMBOLS)
    fitted = fit(have, [both()])
    best[len(have)] = (have, fitted)
    while len(have) > 1:
        smaller = {have - {symbol}: fit(have - {symbol}, [fitted.u]) for symbol in have}
        have, fitted = min(smaller.items(), key=lambda item: item[1].mean)
        if fitted.mean < best[len(have)][1].mean:
            best[len(have)] = (have, fitted)
    return [best[k] for k in sorted(best)]


def power(fitted: Fitted, symbol: str) -> float:
    """Exponent in 1/amplitude by which a parameter differs between the sets."""
    if symbol == WIDTH:
        return float(fitted.u[-1])
    k, n = SYMBOLS.index(symbol), len(SYMBOLS)
    here, more = fitted.u[k], fitted.u[n + k]
    factor = np.log((here + more) / here) if symbol in SIGNED else more
    return float(factor / np.log(5.0))
