"""Static forces of single tests that a fit took out: the gas, or the zero of a load cell."""

from dataclasses import dataclass

import numpy as np

from sysid.data.loops import Loops
from sysid.identification.result import Fit
from sysid.identification.straight_lines.lines import FEWEST_TESTS, Line, fit_line
from sysid.models.simulate import simulate
from sysid.motion.motion import loop_motion


@dataclass(frozen=True)
class Statics:
    """Static forces beside a model that has none.

    Attributes:
        ids: L ids of tests.
        value: [L] N, mean of measured minus simulated force over the loop.
        line: Against temperature; None where temperatures are too few or alike.
        mean_nrmse: Mean of RMSE/max|F| over the fitted tests without these forces.
    """

    ids: tuple[str, ...]
    value: np.ndarray
    line: Line | None
    mean_nrmse: float


def statics_of(fit: Fit, loops: Loops) -> Statics | None:
    """Static forces of the fitted loops, where the fit left them free; None otherwise.

    Args:
        fit: The fit.
        loops: The campaign's loops.
    """
    used = {t.id for t in fit.tests if t.used}
    chosen = loops.select(np.array([name in used for name in loops.ids], dtype=bool))
    if not (fit.coordinates.statics_free and chosen.ids):
        return None
    rest = chosen.force - np.asarray(simulate(fit.valve, loop_motion(chosen)))
    value = rest.mean(axis=1)
    rmse = np.sqrt(np.mean((rest - value[:, None]) ** 2, axis=1))
    return Statics(
        ids=chosen.ids,
        value=value,
        line=_line(chosen.temperature, value),
        mean_nrmse=float(np.mean(rmse / np.abs(chosen.force).max(axis=1))),
    )


def _line(temperature: np.ndarray, value: np.ndarray) -> Line | None:
    """All tests alike; what they scatter by beyond the line is in its intervals."""
    known = np.isfinite(temperature)
    t, y = temperature[known], value[known]
    if t.size < FEWEST_TESTS or np.ptp(t) <= 0.0:
        return None
    return fit_line(t, y, np.full(t.size, np.nan), np.ones(t.size))
