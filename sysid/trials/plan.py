"""Plans: which trials a study consists of, from a file or from the command line."""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Annotated, Final

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sysid.errors import DataError
from sysid.trials.trial_id import BLOCK, TrialId, check, first_seed

COUNTS: Final = {
    "none": 180, "none_misfit": 180, "one": 156, "one_misfit": 182, "outside": 88, "two": 100,
    "bouc_wen": 60, "invisible": 24, "history": 30, "physical": 40,
}  # fmt: skip
"""Trials of the full study."""
Numbers = float | tuple[float, ...] | None
_NUMBERS: Final = ("percent", "misfit", "noise", "level")


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Group(_Part):
    """Trials of one regime: every combination of the sizes, misfits, noises and levels given.

    Attributes:
        regime: Name, or "physical".
        count: Trials of each combination.
        first: So many of the regime's trials are passed over.
        percent: Sizes of what is hidden, % of the RMS force.
        misfit: Structural misfits, %.
        noise: Of the force, N per point and cycle.
        level: Of raised mechanisms.
        effects: What is hidden, in turn; what the regime hides if none is given.
    """

    regime: str
    count: Annotated[int, Field(ge=1, le=BLOCK)] = 20
    first: Annotated[int, Field(ge=0, lt=BLOCK)] = 0
    percent: Numbers = None
    misfit: Numbers = None
    noise: Numbers = None
    level: Numbers = None
    effects: tuple[str, ...] = ()

    def trials(self) -> list[list[TrialId]]:
        """The trials of each combination.

        Raises:
            DataError: One of them cannot be run, or there are not so many.
        """
        begin = first_seed(self.regime)
        if self.first + self.count > BLOCK:
            raise DataError(
                f"{self.regime} has no {self.first + self.count} trials",
                advice=f"first and count are {BLOCK} at most together",
            )
        values = [_each(name, getattr(self, name)) for name in _NUMBERS]
        found = []
        for percent, misfit, noise, level in product(*values):
            one = [
                TrialId(
                    self.regime, begin + turn,
                    (self.effects[turn % len(self.effects)],) if self.effects else (),
                    percent, misfit, noise, level,
                )
                for turn in range(self.first, self.first + self.count)
            ]  # fmt: skip
            for trial in one:
                check(trial)
            found.append(one)
        return found


class _File(_Part):
    trials: Annotated[tuple[Group, ...], Field(min_length=1)]


@dataclass(frozen=True)
class Plan:
    """What a study consists of.

    Attributes:
        groups: Of trials.
    """

    groups: tuple[Group, ...]

    def trials(self) -> list[TrialId]:
        """All of them, groups mixed in proportion: a study that is stopped early is of them all.

        Raises:
            DataError: One cannot be run, or stands there twice.
        """
        each = [one for group in self.groups for one in group.trials()]
        placed = [((k + 0.5) / len(one), n, t) for n, one in enumerate(each)
                  for k, t in enumerate(one)]  # fmt: skip
        trials = [t for _, _, t in sorted(placed, key=lambda p: p[:2])]
        if len(set(map(str, trials))) < len(trials):
            raise DataError("a trial stands in the plan twice", advice="Give them other seeds")
        return trials


def full_plan(regimes: Sequence[str] = (), count: int | None = None, first: int = 0) -> Plan:
    """The plan of some regimes.

    Args:
        regimes: Names; all if there are none.
        count: Trials of each; those of the full study if not given.
        first: So many of each regime's trials are passed over.
    """
    names = regimes or tuple(COUNTS)
    return Plan(
        tuple(Group(regime=n, count=count or COUNTS.get(n, 20), first=first) for n in names)
    )


def read_plan(path: Path) -> Plan:
    """A plan from a TOML file with tables ``[[trials]]``.

    Raises:
        DataError: It cannot be read, is no plan, or holds a trial that cannot be run.
    """
    try:
        content = tomllib.loads(path.read_text("utf-8"))
        plan = Plan(_File.model_validate(content).trials)
        plan.trials()
        return plan
    except DataError as cause:
        raise DataError(cause.what, where=path, advice=cause.advice) from cause
    except OSError as cause:
        raise DataError(
            f"the plan cannot be read: {cause.strerror}",
            where=path,
            advice="Give the path of a plan (TOML, tables [[trials]]), or leave PLAN out for the "
            "full study",
        ) from cause
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as cause:
        raise DataError(f"is no TOML: {cause}", where=path) from cause
    except ValidationError as cause:
        first = cause.errors()[0]
        where = ".".join(str(z) for z in first["loc"])
        raise DataError(
            f"{where}: {first['msg'].lower()}",
            where=path,
            advice="A plan has tables [[trials]] with regime, count, first, percent, misfit, "
            "noise, level, effects",
        ) from cause


def _each(name: str, value: Numbers) -> tuple[float | None, ...]:
    if value is None:
        return (None,)
    if value == ():
        raise DataError(f"{name} is empty", advice="Give it numbers, or leave it out")
    return value if isinstance(value, tuple) else (value,)
