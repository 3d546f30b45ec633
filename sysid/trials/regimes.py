"""Regimes of blind trials: what is hidden, how large, in what damper; and plans of trials."""

from dataclasses import dataclass, replace
from itertools import combinations
from typing import Final, Literal

import numpy as np

from sysid.errors import DataError
from sysid.rig.planters.planter import Planter
from sysid.rig.planters.registry import CATALOGUE, HISTORY, INVISIBLE, OUTSIDE, find_planter
from sysid.rig.trial_design import STANDARD, TrialDesign

_STRIDE: Final = 7
"""Planters take turns in strides, so that a short plan has effects of many families."""
_CHOICE: Final = 77
"""Stream of random numbers by which plans are drawn."""


@dataclass(frozen=True)
class Regime:
    """One kind of trial.

    Attributes:
        name: Of the regime.
        about: In words.
        pool: Planters, one of which (or a pair) is hidden in each trial, in turn; empty for none.
        effects: How many are hidden at once.
        percent: Size of each, % of the RMS force.
        misfits: Structural misfits of the refitted base, % of the RMS force; one is drawn.
        model: Law of the damper.
    """

    name: str
    about: str
    pool: tuple[Planter, ...] = ()
    effects: int = 1
    percent: float = 0.0
    misfits: tuple[float, ...] = (0.0,)
    model: Literal["w11", "bouc_wen"] = "w11"


REGIMES: Final[tuple[Regime, ...]] = (
    Regime("none", "no effect, correct base"),
    Regime("none_misfit", "no effect, 2 or 5 % structural misfit", misfits=(2.0, 5.0)),
    Regime("one", "one effect of 1 %, correct base", CATALOGUE, percent=1.0),
    Regime(
        "one_misfit", "one effect of 2 %, 2 or 5 % misfit", CATALOGUE, percent=2.0,
        misfits=(2.0, 5.0),
    ),
    Regime("outside", "one effect of 2 % that is not in the catalogue", OUTSIDE, percent=2.0),
    Regime("two", "two effects of 1 % of different families", CATALOGUE, effects=2, percent=1.0),
    Regime("bouc_wen", "no effect, data of another model class", model="bouc_wen"),
    Regime("invisible", "one effect that the base absorbs, 2 %", INVISIBLE, percent=2.0),
    Regime("history", "one effect of 2 % that needs run order or cycles", HISTORY, percent=2.0),
)  # fmt: skip


@dataclass(frozen=True)
class TrialSpec:
    """One trial, before it is run.

    Attributes:
        regime: Name.
        seed: Of the campaign.
        planters: Names of what is hidden.
        percents: Sizes, % of the RMS force.
        misfit: Wanted structural misfit of the refitted base, % of the RMS force.
        design: How the campaign is run, without the misfit.
    """

    regime: str
    seed: int
    planters: tuple[str, ...]
    percents: tuple[float, ...]
    misfit: float
    design: TrialDesign

    @property
    def hidden(self) -> tuple[Planter, ...]:
        """The planters, at their factory sizes."""
        return tuple(find_planter(name) for name in self.planters)


def find_regime(name: str) -> Regime:
    """The regime of a name.

    Raises:
        DataError: There is none.
    """
    for regime in REGIMES:
        if regime.name == name:
            return regime
    known = ", ".join(regime.name for regime in REGIMES)
    raise DataError(f"there is no regime {name!r}", advice=f"Regimes: {known}")


def plan(regime: str, count: int, seed: int) -> tuple[TrialSpec, ...]:
    """Trials of one regime, with consecutive seeds.

    Planters take turns, so that each is hidden as often as any other; misfits and pairs are drawn.

    Args:
        regime: Name.
        count: How many.
        seed: Of the first.
    """
    kind = find_regime(regime)
    return tuple(_spec(kind, k, seed + k) for k in range(count))


def _spec(regime: Regime, turn: int, seed: int) -> TrialSpec:
    random = np.random.default_rng([seed, _CHOICE])
    misfit = float(random.choice(regime.misfits))
    hidden: tuple[Planter, ...] = ()
    if regime.effects == 2:
        pairs = [pair for pair in combinations(regime.pool, 2) if pair[0].family != pair[1].family]
        hidden = pairs[int(random.integers(len(pairs)))]
    elif regime.pool:
        hidden = (regime.pool[_STRIDE * turn % len(regime.pool)],)
    return TrialSpec(
        regime=regime.name,
        seed=seed,
        planters=tuple(planter.name for planter in hidden),
        percents=(regime.percent,) * len(hidden),
        misfit=misfit,
        design=replace(STANDARD, model=regime.model),
    )
