"""What BS09 says of its isolator, held against simulations of its Table 1."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from outcome import Outcome

from sysid.isolator.base_motion import (
    LEVEL,
    ORDER,
    BaseMotion,
    butterworth_motion,
    road_motion,
)
from sysid.isolator.closed_loop import CLOCK, SENSOR, Clock, Sensor
from sysid.isolator.compare import Band, Change, change, rival
from sysid.isolator.families import CONTROLLED, family
from sysid.isolator.from_card import alone, at_temperatures
from sysid.isolator.hardware_in_loop import Actuator, rig_isolator
from sysid.isolator.plant import Plant, mass_isolator
from sysid.isolator.quarter_car import BODY, WHEEL, quarter_car
from sysid.isolator.sensitivity import CASES, changes_by_law, one_law_at_a_time
from sysid.isolator.study import ConflictDiagram, conflict_diagram, ideal_curve, stacked
from sysid.models.lumped import TABLE_1, Lumped
from sysid.parameters import build

VALVE: Final = build(Lumped, TABLE_1)
TEMPERATURES: Final = (15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0)
ENDS: Final = (15.0, 75.0)
SHOWN: Final = {"P": 2000.0, "PID": 2000.0, "GS": 3500.0, "OO": 0.2}
OTHERS: Final = ("PID", "GS", "OO")
ACTUATORS: Final = (
    Actuator(1e-3), Actuator(2e-3), Actuator(3e-3), Actuator(5e-3),
    Actuator(5e-3, compensation=4e-3),
)  # fmt: skip


def run(
    base: BaseMotion,
    plant: Plant | None = None,
    clock: Clock = CLOCK,
    temperatures: Sequence[float] = ENDS,
    sensor: Sensor = SENSOR,
) -> ConflictDiagram:
    """All four controllers at all set points."""
    return conflict_diagram(
        mass_isolator() if plant is None else plant,
        [family(name, VALVE) for name in CONTROLLED],
        at_temperatures(VALVE, temperatures),
        [f"{t:g}" for t in temperatures],
        base,
        clock,
        sensor,
    )


def against_paper(outcome: Outcome, diagram: ConflictDiagram, base: BaseMotion) -> None:
    """Temperature, orderings, and laws one at a time."""
    last = len(TEMPERATURES) - 1
    changes = [change(diagram.curve(n), point, 0, last) for n, point in SHOWN.items()]
    outcome.say(
        "From 15 to 75 °C, per cent, mean over motions with its 95 % interval.  The paper's",
        "experiment (P, D = 2 kN·s/m): acceleration −8 %, working space +6 %.",
    )
    head = ("controller", "set point", "RMS acceleration", "single motions", "RMS working space")
    outcome.table(
        head,
        [
            (c.name, f"{c.set_point:g}", told(c.acceleration), spread(c.acceleration),
             told(c.working_space))
            for c in changes
        ],
    )  # fmt: skip
    outcome.numbers["cold_to_warm"] = {c.name: _both(c) for c in changes}
    outcome.say("RMS acceleration over that of P at equal working space, per cent:")
    rows = [(f"{t:g}", *orderings(diagram, k)) for k, t in enumerate(TEMPERATURES)]
    outcome.table(("°C", *OTHERS), rows)
    outcome.numbers["over_P"] = {
        f"{t:g}": {
            n: vars(found.excess)
            for n in OTHERS
            if (found := rival(diagram, n, "P", k)) is not None
        }
        for k, t in enumerate(TEMPERATURES)
    }
    ideal = ideal_curve((1400.0, 2000.0, 3500.0), base)
    outcome.say(
        "Ideal, active skyhook with D = 1.4, 2 and 3.5 kN·s/m:",
        ", ".join(f"{a:.2f}" for a in ideal.acceleration.mean(axis=2).ravel()),
        "m/s² at",
        ", ".join(f"{1e3 * a:.2f}" for a in ideal.working_space.mean(axis=2).ravel()),
        "mm; P with D = 2 kN·s/m at 15 °C:",
        "{:.2f} m/s² at {:.2f} mm.".format(*_point(diagram)),
    )
    laws_at_a_time(outcome, base)


def laws_at_a_time(outcome: Outcome, base: BaseMotion) -> None:
    """Fig. 12."""
    points = [family(n, VALVE, set_points=(SHOWN[n],)) for n in CONTROLLED]
    dampers = stacked(one_law_at_a_time(alone(VALVE), *ENDS))
    laws = changes_by_law(conflict_diagram(mass_isolator(), points, dampers, CASES, base))
    outcome.say(
        "One law at 75 °C, all others at 15 °C (Fig. 12): RMS acceleration / RMS working space,",
        "per cent.",
    )
    outcome.table(
        ("law", *CONTROLLED),
        [(case, *(f"{told(c.acceleration)} / {short(c.working_space)}" for c in changes))
         for case, changes in laws.items()],
    )  # fmt: skip
    outcome.numbers["laws"] = {
        case: {c.name: _both(c) for c in changes} for case, changes in laws.items()
    }


def sweeps(outcome: Outcome, motions: int) -> None:
    """What the paper does not give, one at a time."""
    seeds = range(1, motions + 1)
    base = butterworth_motion(seeds)
    cases: list[tuple[str, ConflictDiagram]] = [("as it is", run(base))]
    for level in (0.5 * LEVEL, 2.0 * LEVEL):
        words = f"base of {1e3 * level:.2g} mm RMS"
        cases.append((words, run(butterworth_motion(seeds, level=level))))
    for order in (2, 8):
        words = f"filter of order {order}, not {ORDER}"
        cases.append((words, run(butterworth_motion(seeds, order=order))))
    cases += [(f"mass {m:g} kg", run(base, mass_isolator(m))) for m in (80.0, 130.0)]
    small, words = butterworth_motion(seeds, level=0.5 * LEVEL), f"{500 * LEVEL:.2g} mm"
    cases.append((f"mass 130 kg and base of {words}", run(small, mass_isolator(130.0))))
    for period in (0.5e-3, 2e-3):
        clock = Clock(period, round(period / CLOCK.step))
        cases.append((f"controllers at {1e-3 / period:g} kHz", run(base, clock=clock)))
    rows = []
    for words, found in cases:
        one = change(found.curve("P"), SHOWN["P"], 0, 1)
        cells = (told(one.acceleration), told(one.working_space))
        rows.append((words, *cells, *orderings(found, 0), *orderings(found, 1)))
    outcome.say(
        "What the paper does not give, and was fixed beforehand: change of P (D = 2 kN·s/m) from",
        "15 to 75 °C, and RMS acceleration over that of P at equal working space, per cent.",
    )
    outcome.table(("", "acceleration", "working space", *_at_both_ends()), rows)


def rig(outcome: Outcome, base: BaseMotion) -> None:
    """The damper behind an actuator."""
    plain, rows, numbers = run(base), [], []
    for actuator in ACTUATORS:
        found = run(base, rig_isolator(actuator))
        moved = [_shift(found, plain, kind) for kind in ("acceleration", "working_space")]
        words = f"{1e3 * actuator.delay:g} ms"
        if actuator.compensation:
            words += f", {1e3 * actuator.compensation:g} ms of it compensated"
        one = change(found.curve("P"), SHOWN["P"], 0, 1)
        rows.append((
            words, " / ".join(f"{100 * z:+.1f}" for z in moved),
            f"{told(one.acceleration)} / {short(one.working_space)}",
            *orderings(found, 0), *orderings(found, 1),
        ))  # fmt: skip
        numbers.append({
            "delay_s": actuator.delay, "compensation_s": actuator.compensation,
            "shift_of_P": moved, "cold_to_warm": _both(one),
        })  # fmt: skip
    outcome.say(
        "Simulated hardware in the loop: the damper behind an actuator of second order, damping",
        "0.7, that comes late.  Shift of P (D = 2 kN·s/m, 15 °C) against the plain isolator, its",
        "change to 75 °C (acceleration / working space); RMS acceleration over that of P at equal",
        "working space; per cent.",
    )
    outcome.table(("actuator", "shift", "15 to 75 °C", *_at_both_ends()), rows)
    outcome.numbers["rig"] = numbers


def car(outcome: Outcome, motions: int) -> None:
    """A quarter car on a road."""
    found = run(road_motion(range(1, motions + 1)), quarter_car())
    changes = [change(found.curve(n), point, 0, 1) for n, point in SHOWN.items()]
    outcome.say(
        f"A quarter car ({BODY:g} and {WHEEL:g} kg) on {found.motion}: from 15 to 75 °C, and RMS",
        "acceleration over that of P at equal working space, 15 and 75 °C; per cent.",
    )
    rows = []
    for one in changes:
        beside = [rival(found, one.name, "P", k) if one.name != "P" else None for k in (0, 1)]
        cells = ("" if r is None else told(r.excess) for r in beside)
        rows.append((one.name, f"{one.set_point:g}", told(one.acceleration),
                     told(one.working_space), *cells))  # fmt: skip
    head = ("controller", "set point", "acceleration", "working space", "over P, 15 °C", "75 °C")
    outcome.table(head, rows)
    outcome.numbers["quarter_car"] = {c.name: _both(c) for c in changes}


def orderings(diagram: ConflictDiagram, variant: int) -> list[str]:
    """All others against P."""
    found = [rival(diagram, name, "P", variant) for name in OTHERS]
    return ["no space shared" if r is None else told(r.excess) for r in found]


def told(band: Band) -> str:
    """Per cent."""
    return f"{short(band)} ({100 * band.low:+.1f} … {100 * band.high:+.1f})"


def short(band: Band) -> str:
    """The mean alone."""
    return f"{100 * band.value:+.1f}"


def spread(band: Band) -> str:
    """Of single motions."""
    return f"{100 * band.single_low:+.1f} … {100 * band.single_high:+.1f}"


def _at_both_ends() -> list[str]:
    return [f"{name} {t:g} °C" for t in ENDS for name in OTHERS]


def _both(change: Change) -> dict[str, Any]:
    return {
        "set_point": change.set_point,
        "acceleration": vars(change.acceleration),
        "working_space": vars(change.working_space),
    }


def _point(diagram: ConflictDiagram) -> tuple[float, float]:
    curve = diagram.curve("P")
    at = curve.set_points.index(SHOWN["P"])
    return float(curve.acceleration[at, 0].mean()), 1e3 * float(curve.working_space[at, 0].mean())


def _shift(found: ConflictDiagram, plain: ConflictDiagram, kind: str) -> float:
    at = plain.curve("P").set_points.index(SHOWN["P"])
    one, other = (getattr(d.curve("P"), kind)[at, 0] for d in (found, plain))
    return float(np.mean(one / other) - 1.0)
