"""What gas, and what a better table, is worth to an isolator: two claims of BS09."""

from dataclasses import replace
from typing import Final

import numpy as np
from isolator_paper import VALVE, run, told
from outcome import Outcome

from sysid.isolator.base_motion import BaseMotion
from sysid.isolator.closed_loop import Sensor
from sysid.isolator.compare import rival
from sysid.isolator.families import CONTROLLED, Gains
from sysid.isolator.plant import mass_isolator
from sysid.isolator.study import ConflictDiagram
from sysid.isolator.worth import Worth, scheduled, worth_of_tables

GASES: Final = (
    ("60 N in the reading", 0.0, Sensor(60.0)),
    ("120 N in the reading", 0.0, Sensor(120.0)),
    ("taken off the reading, 1.5 kN/m", 1500.0, Sensor(0.0, 1500.0)),
    ("60 N and 1.5 kN/m", 1500.0, Sensor(60.0, 1500.0)),
)
PER_DECADE: Final = (-0.3, -0.1, 0.0, 0.1, 0.3)


def gas(outcome: Outcome, base: BaseMotion) -> None:
    """Does the accumulator's force matter to the suspension?"""
    plain, rows, numbers = run(base), [], []
    for words, stiffness, sensor in GASES:
        found = run(base, mass_isolator(gas_stiffness=stiffness), sensor=sensor)
        beside = {}
        for name in CONTROLLED:
            curves = (plain.curve(name), replace(found.curve(name), name="with gas"))
            both = ConflictDiagram(plain.variants, plain.motion, curves)
            one = rival(both, "with gas", name, 0)
            beside[name] = None if one is None else one.excess
        rows.append((words, *("" if b is None else told(b) for b in beside.values())))
        numbers.append(
            {"gas": words, **{n: None if b is None else vars(b) for n, b in beside.items()}}
        )
    outcome.say(
        "Gas: a static force is carried by the isolator's spring and left in the reading of the",
        "force sensor only; a stiffness acts.  RMS acceleration over that without gas at equal",
        "working space, 15 °C, per cent.",
    )
    outcome.table(("gas", *CONTROLLED), rows)
    outcome.numbers["gas"] = numbers


def worth(outcome: Outcome, base: BaseMotion) -> None:
    """Gain schedules from wrong and right tables."""
    rows, numbers = [], []
    for per_decade in PER_DECADE:
        at_four, at_five, at_eight = (1.0 + per_decade * np.log10(f) for f in (4.0, 5.0, 8.0))
        right = {"yielding": at_five, "post": at_five}
        tables = [
            scheduled(VALVE, "base", yielding=at_four, post=at_eight),
            scheduled(VALVE, "extended", **right),
            scheduled(VALVE, "warm", Gains(temperature=75.0), **right),
            scheduled(VALVE, "low", yielding=0.7, post=0.7),
            scheduled(VALVE, "high", yielding=1.3, post=1.3),
        ]
        found = worth_of_tables(
            mass_isolator(), VALVE, tables, base, temperature=75.0, per_decade=per_decade
        )
        rows.append((f"{100 * per_decade:+g} %", *_worth_cells(found)))
        back = rival(found.diagram, "extended", "base", 0)
        numbers.append({
            "per_decade": per_decade, "over_P": {r.name: vars(r.excess) for r in found.over_p},
            "extended_over_base": None if back is None else vars(back.excess),
        })  # fmt: skip
    outcome.say(
        "A damper at 75 °C whose force changes by so much per decade of frequency.  Gain schedules",
        "with tables at 15 °C from the base model as fitted at 8 Hz (C_post) and 4 Hz (F_y), from",
        "the extended model at 5 Hz, from that at 75 °C, and from tables that are 30 % wrong: RMS",
        "acceleration over that of P at equal working space; last, extended over base; per cent.",
    )
    head = ("per decade", "PID", "base", "extended", "at 75 °C", "30 % low", "30 % high")
    outcome.table((*head, "extended / base"), rows)
    outcome.numbers["worth"] = numbers


def _worth_cells(found: Worth) -> list[str]:
    by = {r.name: told(r.excess) for r in found.over_p}
    back = rival(found.diagram, "extended", "base", 0)
    names = ("PID", "base", "extended", "warm", "low", "high")
    return [*(by.get(n, "") for n in names), "" if back is None else told(back.excess)]
