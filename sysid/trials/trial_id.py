"""Trials by name: ``one:30003`` says all that is needed to run that trial again."""

from dataclasses import dataclass, replace
from typing import Final

from sysid.errors import DataError
from sysid.rig.physical.mechanisms import MECHANISMS
from sysid.rig.planters.registry import find_planter
from sysid.trials.regimes import REGIMES, TrialSpec, find_regime, plan

BLOCK: Final = 10_000
"""Seeds of a regime; each has a block of its own, in the order of `REGIMES`."""
PHYSICAL: Final = "physical"
"""The tier whose damper is made of its physics, beside the regimes."""
FIRST_SEED: Final = {
    name: BLOCK * (k + 1) for k, name in enumerate((*(r.name for r in REGIMES), PHYSICAL))
}
"""Regime → seed of its first trial."""
LEVEL: Final = 3.0
"""Level of a mechanism that is raised, where nothing else is asked."""
_ADVICE: Final = (
    "A trial is written REGIME:SEED, or with more behind it, such as one:30003:percent=0.5, "
    "one:30003:effect=gas_preload, one_misfit:40001:misfit=5:noise=18, physical:100000:level=5"
)


@dataclass(frozen=True)
class TrialId:
    """One trial.

    Attributes:
        regime: Name, or "physical".
        seed: Of the campaign, in the regime's block.
        effects: What is hidden, where it is not what the seed says.
        percent: Size of each, % of the RMS force, where it is not the regime's.
        misfit: Structural misfit, %, where it is not what the seed says.
        noise: Of the force, N per point and cycle, where it is not the standard rig's.
        level: Of a raised mechanism of the physical damper.
    """

    regime: str
    seed: int
    effects: tuple[str, ...] = ()
    percent: float | None = None
    misfit: float | None = None
    noise: float | None = None
    level: float | None = None

    @property
    def kind(self) -> str:
        """The regime, and what was asked for otherwise: trials of one kind are counted together."""
        return ", ".join((self.regime, *(f"{name} {value}" for name, value in self._other())))

    @property
    def turn(self) -> int:
        """Place in the regime, from 0."""
        return self.seed - FIRST_SEED[self.regime]

    def __str__(self) -> str:
        words = [self.regime, str(self.seed)]
        if self.effects:
            words.append(f"effect={'+'.join(self.effects)}")
        return ":".join([*words, *(f"{name}={value}" for name, value in self._other())])

    def _other(self) -> list[tuple[str, str]]:
        names = ("percent", "misfit", "noise", "level")
        return [(n, f"{v:g}") for n in names if (v := getattr(self, n)) is not None]


def parse_id(text: str) -> TrialId:
    """The trial of a name.

    Raises:
        DataError: It is no trial.
    """
    regime, _, rest = text.partition(":")
    seed, *more = rest.split(":")
    try:
        fields = dict(word.split("=", 1) for word in more)
        effects = tuple(name for name in fields.pop("effect", "").split("+") if name)
        numbers = {name: float(value) for name, value in fields.items()}
        found = TrialId(regime, int(seed), effects, **numbers)
    except (ValueError, TypeError) as cause:
        raise DataError(f"{text!r} is no trial", advice=_ADVICE) from cause
    check(found)
    return found


def first_seed(regime: str) -> int:
    """Seed of the first trial of a regime.

    Raises:
        DataError: There is no such regime.
    """
    if regime not in FIRST_SEED:
        known = ", ".join(FIRST_SEED)
        raise DataError(f"there is no regime {regime!r}", advice=f"Regimes: {known}")
    return FIRST_SEED[regime]


def check(trial: TrialId) -> None:
    """Refuse what cannot be run.

    Raises:
        DataError: The regime, an effect or the seed does not exist, or a number or a second effect
            has no place there.
    """
    first = first_seed(trial.regime)
    if not 0 <= trial.turn < BLOCK:
        raise DataError(
            f"seed {trial.seed} does not belong to {trial.regime}",
            advice=f"Its seeds are {first} to {first + BLOCK - 1}",
        )
    physical = trial.regime == PHYSICAL
    if physical and len(trial.effects) > 1:
        raise DataError(
            f"a physical trial raises one mechanism, not {' and '.join(trial.effects)}",
            advice="Give one effect",
        )
    for effect in trial.effects:
        if not physical:
            find_planter(effect)
        elif effect not in (*(m.name for m in MECHANISMS), "none"):
            known = ", ".join(m.name for m in MECHANISMS)
            raise DataError(f"there is no mechanism {effect!r}", advice=f"Mechanisms: {known}")
    foreign = ("percent", "misfit", "noise") if physical else ("level",)
    for name in foreign:
        if getattr(trial, name) is not None:
            raise DataError(f"{name} means nothing in {trial.regime} trials", advice=_ADVICE)
    for name in ("percent", "misfit", "noise", "level"):
        value = getattr(trial, name)
        if value is not None and not 0.0 <= value < 1e6:
            raise DataError(f"{name}={value:g} is out of range", advice=_ADVICE)
    _check_size(trial)


def _check_size(trial: TrialId) -> None:
    """An effect of no size would be scored as if it were there."""
    if trial.regime == PHYSICAL:
        return
    size = find_regime(trial.regime).percent if trial.percent is None else trial.percent
    if size > 0.0:
        return
    if trial.effects:
        raise DataError(
            f"{' and '.join(trial.effects)} would be hidden with a size of 0 %",
            advice="Give its size, such as percent=1",
        )
    if trial.percent is not None and find_regime(trial.regime).percent > 0.0:
        raise DataError(
            "an effect would be hidden with a size of 0 %",
            advice="Give a size above 0, or a trial without effects, such as none:10000",
        )


def spec_of(trial: TrialId) -> TrialSpec:
    """A trial of the hysteretic damper, as `sysid.trials` runs it."""
    spec = plan(trial.regime, trial.turn + 1, FIRST_SEED[trial.regime])[-1]
    planters = trial.effects or spec.planters
    percent = find_regime(trial.regime).percent if trial.percent is None else trial.percent
    design = spec.design if trial.noise is None else replace(spec.design, noise=trial.noise)
    return replace(
        spec,
        planters=planters,
        percents=(percent,) * len(planters),
        misfit=spec.misfit if trial.misfit is None else trial.misfit,
        design=design,
    )
