"""The one setting of the campaign at which a model errs far more, or less, than at all others."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops
from sysid.diagnosis.words import current_words, percent, plain
from sysid.identification.straight_lines.levels import (
    AMPLITUDE_GAP,
    FREQUENCY_GAP,
    current_levels,
    grouped,
)

MORE: Final = 2.0
"""How many times the error at any other setting makes one stand out."""
LESS: Final = 4.0
"""How many times less than at any other setting makes one stand out."""
FEWEST: Final = 2
"""Tests at a setting below which it is no setting's error but a test's."""


@dataclass(frozen=True)
class OddLevel:
    """A setting that stands out.

    Attributes:
        setting: E.g. "0 A".
        others: What the other settings are called, e.g. "currents".
        there: Mean RMSE/max|F| of its tests.
        elsewhere: Of the other settings' means the one next to it.
    """

    setting: str
    others: str
    there: float
    elsewhere: float

    @property
    def words(self) -> str:
        """A sentence."""
        if self.there > self.elsewhere:
            return (
                f"Relative to the peak force it is worst at {self.setting}: {percent(self.there)} "
                f"there, at other {self.others} at most {percent(self.elsewhere)}."
            )
        return (
            f"Relative to the peak force it is far smaller at {self.setting}: "
            f"{percent(self.there)} there, at other {self.others} "
            f"{percent(self.elsewhere)} and more."
        )


def odd_level(
    loops: Loops,
    simulated: Float[np.ndarray, "loop phase"],
    truth: Float[np.ndarray, "loop phase"],
) -> OddLevel | None:
    """The current, amplitude or frequency at which a model's relative error stands out most.

    Args:
        loops: L tests.
        simulated: [L, J] N.
        truth: [L, J] N.

    Returns:
        None where no setting's error is `MORE` times that of every other one, nor `LESS` times
        less.
    """
    peak = np.maximum(np.abs(truth).max(axis=1), 1e-300)
    share = np.sqrt(np.mean((simulated - truth) ** 2, axis=1)) / peak
    found: list[tuple[float, OddLevel]] = []
    for others, levels in _settings(loops).items():
        means = np.array([max(float(np.mean(share[places])), 1e-300) for _, places in levels])
        if means.size < 2:
            continue
        for k, sign, least in ((np.argmax(means), 1.0, MORE), (np.argmin(means), -1.0, LESS)):
            setting, places = levels[int(k)]
            rest = np.delete(means, k)
            next_to_it = float(rest.max() if sign > 0.0 else rest.min())
            times = (float(means[k]) / next_to_it) ** sign
            if places.size >= FEWEST and times > least:
                found.append((times, OddLevel(setting, others, float(means[k]), next_to_it)))
    return max(found, key=lambda pair: pair[0])[1] if found else None


def _settings(loops: Loops) -> dict[str, list[tuple[str, np.ndarray]]]:
    """What the other settings are called → each setting in words, with the places that have it."""
    known = np.flatnonzero(np.isfinite(loops.current))
    levels = current_levels(loops.current[known]) if known.size else []
    found = {"currents": [(current_words(level), known[at]) for level, at in levels]}
    for name, values, gap, factor, unit in (
        ("amplitudes", loops.amplitude, AMPLITUDE_GAP, 1e3, "mm"),
        ("frequencies", loops.frequency, FREQUENCY_GAP, 1.0, "Hz"),
    ):
        groups = grouped(np.log(values), gap)
        found[name] = [(f"{plain(factor * np.median(values[g]))} {unit}", g) for g in groups]
    return found
