"""The one setting of the campaign at which a model errs far more than at all others."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops
from sysid.diagnosis.words import percent, plain
from sysid.identification.straight_lines.levels import (
    AMPLITUDE_GAP,
    FREQUENCY_GAP,
    current_levels,
    grouped,
)

TIMES: Final = 2.0
"""How many times the error at any other setting makes one stand out."""
FEWEST: Final = 2
"""Tests at a setting below which it is no setting's error but a test's."""


@dataclass(frozen=True)
class WorstLevel:
    """A setting that stands out.

    Attributes:
        setting: E.g. "0 A".
        others: What the other settings are called, e.g. "currents".
        there: Mean RMSE/max|F| of its tests.
        elsewhere: The largest of the other settings' means.
    """

    setting: str
    others: str
    there: float
    elsewhere: float

    @property
    def words(self) -> str:
        """A sentence."""
        return (
            f"Relative to the peak force it is worst at {self.setting}: {percent(self.there)} "
            f"there, at other {self.others} at most {percent(self.elsewhere)}."
        )


def worst_level(
    loops: Loops,
    simulated: Float[np.ndarray, "loop phase"],
    truth: Float[np.ndarray, "loop phase"],
) -> WorstLevel | None:
    """The current, amplitude or frequency at which a model's relative error stands out most.

    Args:
        loops: L tests.
        simulated: [L, J] N.
        truth: [L, J] N.

    Returns:
        None where no setting's error is `TIMES` that of every other one.
    """
    peak = np.maximum(np.abs(truth).max(axis=1), 1e-300)
    share = np.sqrt(np.mean((simulated - truth) ** 2, axis=1)) / peak
    found = []
    for others, levels in _settings(loops).items():
        means = np.array([float(np.mean(share[places])) for _, places in levels])
        if means.size < 2:
            continue
        worst = int(np.argmax(means))
        setting, places = levels[worst]
        rest = float(np.delete(means, worst).max())
        if places.size >= FEWEST and means[worst] > TIMES * rest:
            found.append(WorstLevel(setting, others, float(means[worst]), rest))
    return max(found, key=lambda w: w.there / max(w.elsewhere, 1e-300), default=None)


def _settings(loops: Loops) -> dict[str, list[tuple[str, np.ndarray]]]:
    """What the other settings are called → each setting in words, with the places that have it."""
    known = np.flatnonzero(np.isfinite(loops.current))
    levels = current_levels(loops.current[known]) if known.size else []
    found = {"currents": [(f"{plain(level)} A", known[at]) for level, at in levels]}
    for name, values, gap, factor, unit in (
        ("amplitudes", loops.amplitude, AMPLITUDE_GAP, 1e3, "mm"),
        ("frequencies", loops.frequency, FREQUENCY_GAP, 1.0, "Hz"),
    ):
        groups = grouped(np.log(values), gap)
        found[name] = [(f"{plain(factor * np.median(values[g]))} {unit}", g) for g in groups]
    return found
