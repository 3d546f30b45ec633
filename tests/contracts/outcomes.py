"""What an effect does around a valve on a set of loops: force and derivatives, computed once."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import numpy as np

from sysid.effects.base import AbstractEffect
from sysid.effects.registry import EFFECTS, choices
from sysid.models.base import AbstractValve
from sysid.models.damper import Damper
from sysid.motion.motion import Motion
from sysid.parameters import specs

STEP = 1e-6
"""Of a finite difference, in parts of the nominal value."""
FORMS = [(kind, choice) for kind in EFFECTS for choice in choices(kind)]
FORM_IDS = ["-".join([k.facts.id, *(str(v) for v in c.values())]) for k, c in FORMS]


class Outcome(NamedTuple):
    """Forces and derivatives of one form of an effect, [loops, points] each.

    `up` and `down` are the forces where each parameter is larger and smaller by its `step`.
    """

    symbols: list[str]
    nominal: np.ndarray
    zero: np.ndarray
    up: np.ndarray
    down: np.ndarray
    step: np.ndarray
    jacobian: np.ndarray
    at_zero: np.ndarray


def force_of(
    kind: type[AbstractEffect], choice: dict, valve: AbstractValve, motion: Motion
) -> Callable[[jax.Array], jax.Array]:
    """Force of the valve with the effect, as a function of the effect's parameters."""
    symbols = [spec.symbol for spec in specs(kind)]

    def force(vector: jax.Array) -> jax.Array:
        effect = kind(**dict(zip(symbols, vector, strict=True)), **choice)
        return Damper(valve, (effect,)).force(motion)

    return force


def table_of(kind: type[AbstractEffect]) -> tuple[np.ndarray, np.ndarray]:
    """Parameters to compute at (nominal, size zero, steps up, steps down), and the steps."""
    symbols = [spec.symbol for spec in specs(kind)]
    nominal = np.array([kind.facts.nominal[symbol] for symbol in symbols])
    zero = np.where(np.array(symbols) == kind.facts.size, 0.0, nominal)
    steps = np.diag(STEP * nominal)
    return np.concatenate([[nominal, zero], nominal + steps, nominal - steps]), STEP * nominal


def arranged(
    kind: type[AbstractEffect], rows: np.ndarray, nominal: np.ndarray, zero: np.ndarray
) -> Outcome:
    """An outcome from the forces at `table_of`, and the derivatives at its first two rows.

    Args:
        kind: Of n parameters.
        rows: [2 + 2n, loops, points].
        nominal: [n, loops, points].
        zero: [n, loops, points].
    """
    n = len(nominal)
    symbols = [spec.symbol for spec in specs(kind)]
    step = table_of(kind)[1]
    return Outcome(symbols, rows[0], rows[1], rows[2 : 2 + n], rows[2 + n :], step, nominal, zero)


def share_off(result: Outcome, k: int) -> float:
    """Share of the points where derivative and difference differ by 10⁻⁴ of the largest."""
    difference = (result.up[k] - result.down[k]) / (2.0 * result.step[k])
    scale = np.abs(difference).max(initial=0.0)
    rounding = 1e-12 * np.abs(result.nominal).max() / abs(result.step[k])
    off = np.abs(result.jacobian[k] - difference) > 1e-4 * scale + rounding
    return float(off.mean())
