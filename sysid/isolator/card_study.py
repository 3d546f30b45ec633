"""Everything that is asked of a card in an isolator, in one result."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, TypeAlias

import numpy as np
from jaxtyping import Float

from sysid.cards.schema import Card
from sysid.effects.reference_temperature import REFERENCE
from sysid.errors import CardError
from sysid.isolator.base_motion import BaseMotion, butterworth_motion, road_motion
from sysid.isolator.compare import Band, Change, Rival, band, change, nearest, rival
from sysid.isolator.controllers.gain_schedule import SPEED
from sysid.isolator.drawn_dampers import DrawnDampers, can_be_drawn, drawn_dampers
from sysid.isolator.families import (
    CONTROLLED,
    DAMPINGS,
    Family,
    Gains,
    Name,
    Tabled,
    family,
)
from sysid.isolator.from_card import CardDamper, damper_of_card
from sysid.isolator.hardware_in_loop import Actuator, rig_isolator
from sysid.isolator.plant import Plant, mass_isolator
from sysid.isolator.quarter_car import SPRING, quarter_car
from sysid.isolator.sensitivity import CASES, changes_by_law, one_law_at_a_time
from sysid.isolator.study import ConflictDiagram, Curve, conflict_diagram, ideal_curve, stacked
from sysid.isolator.tuning import Ultimate, per_ampere, search_feedback, ultimate

PlantName = Literal["mass", "quarter-car"]
Over: TypeAlias = Float[np.ndarray, "set_points ends draws"]
MOTIONS: Final = 20
DRAWS: Final = 20
DRAWN_MOTIONS: Final = 4
"""Drawn dampers are compared with the card's own on so many motions, the same for all."""
TEMPERATURES: Final = 7
NO_CURRENT: Final = 0.05
"""Part of the card's largest current below which its smallest is none."""
SHOWN: Final[dict[str, float]] = {"P": 2000.0, "PID": 2000.0, "GS": 3500.0, "OO": 0.2}
"""Set points that changes are told at: the paper's 2 kN·s/m and 0.2 A; the largest of the paper's
for gain scheduling, which does next to nothing below."""
SELDOM: Final = 0.01
"""Share of time outside the card's speeds up to which a study is trusted."""
_NARROW: Final = 5.0
"""K; a card that knows less is studied at one temperature."""
RIG: Final = Actuator(delay=1e-3)
"""Of the simulated rig: what a compensated actuator keeps of its delay."""


@dataclass(frozen=True)
class Order:
    """What is asked.

    Attributes:
        plant: "mass", the paper's, or "quarter-car" on a road.
        controllers: Which.
        motions: How many.
        draws: Dampers that the card's uncertainty allows; 0 for none, None for the usual number
            where the card says how sure it is.
        duration: Of each motion, s.
        seed: Of the first motion; the others have the numbers after it.
        tune: Find gains for this damper, instead of the paper's.
    """

    plant: PlantName = "mass"
    controllers: tuple[Name, ...] = CONTROLLED
    motions: int = MOTIONS
    draws: int | None = None
    duration: float = 5.0
    seed: int = 1
    tune: bool = False


@dataclass(frozen=True)
class Drawn:
    """A controller's curve with the card's uncertainty in it.

    Attributes:
        name: Of the controller.
        set_points: Of its curve.
        unit: Of them.
        acceleration: Of each drawn damper over that of the card, mean over motions,
            [set points, cold and warm, draws]; NaN where a run ran away.
        working_space: The same.
        changes: Of acceleration and of working space from cold to warm over draws, at the set
            point that changes are told at; empty at one temperature.
    """

    name: str
    set_points: tuple[float, ...]
    unit: str
    acceleration: Over
    working_space: Over
    changes: tuple[Band, ...]

    def bands(self, end: int) -> tuple[Band, Band]:
        """Of acceleration and working space over draws at the set point that is told.

        Args:
            end: 0, cold, or 1, warm.
        """
        at = nearest(self.set_points, SHOWN[self.name])
        return band(self.acceleration[at, end] - 1.0), band(self.working_space[at, end] - 1.0)


@dataclass(frozen=True)
class CardStudy:
    """A card in an isolator.

    Attributes:
        order: What was asked.
        temperatures: °C of the diagram's variants.
        gains: Of the controllers; gain scheduling reads the card at the coldest temperature.
        ultimate: Of the force loop there; None where the paper's gains are used.
        diagram: Controllers × set points × temperatures × motions.
        passive: At 0 A, at the same temperatures.
        ideal: Ideal skyhook; None where the plant is not the mass.
        changes: From the coldest to the warmest temperature; empty at one temperature.
        rivals: At the coldest and the warmest temperature, against the first controller.
        laws: Case → changes, one law warm at a time; empty at one temperature.
        drawn: Each curve with the card's uncertainty; empty without draws.
        drawn_from: What the draws come from, in words; empty without.
        rig: The same controllers in a simulated rig at the coldest and warmest temperature; None
            where the plant is not the mass.
        rig_rivals: As `rivals`, in the rig.
        beyond: Largest share of time, of all controllers and set points in the mean over motions,
            that the piston is faster than the card's tests.
        fastest: That speed, m/s.
        left_out: Effects of the card that have no say.
    """

    order: Order
    temperatures: tuple[float, ...]
    gains: Gains
    ultimate: Ultimate | None
    diagram: ConflictDiagram
    passive: Curve
    ideal: Curve | None
    changes: tuple[Change, ...]
    rivals: tuple[tuple[Rival, ...], ...]
    laws: dict[str, tuple[Change, ...]]
    drawn: tuple[Drawn, ...]
    drawn_from: str
    rig: ConflictDiagram | None
    rig_rivals: tuple[tuple[Rival, ...], ...]
    beyond: float
    fastest: float
    left_out: tuple[str, ...]

    @property
    def trusted(self) -> bool:
        """The damper stays where the card was identified."""
        return self.beyond <= SELDOM


def study_card(
    card: Card,
    order: Order,
    *,
    where: str = "card",
    say: Callable[[str], None] = lambda line: None,
) -> CardStudy:
    """Put a card into an isolator.

    Args:
        card: Of a supported model (`from_card`).
        order: What is asked.
        where: Its file, for errors.
        say: Told what is under way.

    Raises:
        CardError: The card cannot be run (`damper_of_card`).
        DataError: No such motions, or no table for gain scheduling.
    """
    damper = damper_of_card(card, where=where)
    chosen, left_out = _dampers(card, order, where)
    temperatures = _temperatures(card, damper, where)
    plant, base = _plant(order, damper), _base(order)
    fastest = card.validity.velocity[1]
    gains = Gains(temperature=temperatures[0], speed=min(SPEED, fastest))
    found_ultimate = None
    if order.tune:
        say("tuning")
        gains, found_ultimate = _tuned(damper, gains, plant, base)
    table = damper.table_from(gains.temperature)
    families = [family(name, table, gains) for name in order.controllers]
    say("conflict diagram")
    all_families = [*families, family("passive", table, set_points=(0.0,))]
    found = conflict_diagram(
        plant, all_families, damper.at(temperatures),
        [f"{t:g} °C" for t in temperatures], base, sensor=damper.gas.sensor(), fastest=fastest,
    )  # fmt: skip
    diagram = ConflictDiagram(found.variants, found.motion, found.curves[:-1])
    ends = (0, len(temperatures) - 1)[: len(temperatures)]
    laws, drawn, rig = {}, (), None
    if len(temperatures) > 1 and damper.lumped is not None:
        say("one law at a time")
        laws = _laws(damper, table, gains, order, plant, base, (temperatures[0], temperatures[-1]))
    if chosen is not None:
        say(f"{len(chosen.dampers)} drawn dampers")
        some = BaseMotion(base.interval, base.displacement[:DRAWN_MOTIONS], base.name)
        drawn = _drawn(
            (damper, *chosen.dampers), families, [temperatures[k] for k in ends], plant, some
        )
    if order.plant == "mass":
        say("simulated rig")
        rig = conflict_diagram(
            rig_isolator(RIG), families,
            damper.at([temperatures[k] for k in ends]),
            [f"{temperatures[k]:g} °C" for k in ends], base, sensor=damper.gas.sensor(),
        )  # fmt: skip
    say("ideal skyhook")
    return CardStudy(
        order=order,
        temperatures=temperatures,
        gains=gains,
        ultimate=found_ultimate,
        diagram=diagram,
        passive=found.curves[-1],
        ideal=ideal_curve(DAMPINGS, base) if order.plant == "mass" else None,
        changes=tuple(change(c, SHOWN[c.name], *ends) for c in diagram.curves)
        if len(temperatures) > 1
        else (),
        rivals=tuple(_rivals(diagram, k) for k in ends),
        laws=laws,
        drawn=drawn,
        drawn_from="" if chosen is None else chosen.source,
        rig=rig,
        rig_rivals=() if rig is None else tuple(_rivals(rig, k) for k in range(len(ends))),
        beyond=max(float(c.beyond.mean(axis=2).max()) for c in diagram.curves),
        fastest=fastest,
        left_out=(*damper.left_out, *left_out, *_below(card)),
    )


def _below(card: Card) -> tuple[str, ...]:
    """Controllers go down to 0 A, whether the card was identified there or not."""
    low, high = card.validity.current
    if low < NO_CURRENT * high:
        return ()
    return (f"currents below {low:.3g} A are commanded, and outside the card's validity",)


def _dampers(card: Card, order: Order, where: str) -> tuple[DrawnDampers | None, tuple[str, ...]]:
    """Dampers that the card's uncertainty allows, and a word where there are none."""
    if order.draws is None and not can_be_drawn(card):
        return None, ("no dampers are drawn: the card has no covariance",)
    count = DRAWS if order.draws is None else order.draws
    return (drawn_dampers(card, count, order.seed, where=where) if count else None), ()


def _temperatures(card: Card, damper: CardDamper, where: str) -> tuple[float, ...]:
    box = card.validity.temperature
    if not damper.warm:
        return (REFERENCE if box is None else float(f"{0.5 * sum(box):.4g}"),)
    if box is None:
        raise CardError(
            "the card does not say at what temperatures its damper was tested",
            where=f"{where}, validity",
            advice="Fit tests whose temperature is known",
        )
    low, high = (float(f"{z:.4g}") for z in box)
    if high - low < _NARROW:
        return (0.5 * (low + high),)
    return tuple(np.round(np.linspace(low, high, TEMPERATURES), 2).tolist())


def _plant(order: Order, damper: CardDamper) -> Plant:
    if order.plant == "mass":
        return mass_isolator(gas_stiffness=damper.gas.stiffness)
    return quarter_car(spring=SPRING + damper.gas.stiffness)


def _base(order: Order) -> BaseMotion:
    seeds = range(order.seed, order.seed + order.motions)
    if order.plant == "mass":
        return butterworth_motion(seeds, duration=order.duration)
    return road_motion(seeds, duration=order.duration)


def _tuned(
    damper: CardDamper, gains: Gains, plant: Plant, base: BaseMotion
) -> tuple[Gains, Ultimate]:
    """Gains for the cold damper: PID after Ziegler and Nichols, B and G by search at 2 kN·s/m."""
    cold, table = damper.step(gains.temperature), damper.table_from(gains.temperature)
    oscillates = ultimate(cold, table, gains.speed)
    slope = per_ampere(table, gains.speed)
    feedback, feedforward = search_feedback(plant, cold, slope, base, SHOWN["P"]).best
    tuned = replace(gains, feedback=feedback, feedforward=feedforward, pid=oscillates.pid)
    return tuned, oscillates


def _rivals(diagram: ConflictDiagram, variant: int) -> tuple[Rival, ...]:
    first = diagram.curves[0].name
    found = (rival(diagram, c.name, first, variant) for c in diagram.curves[1:])
    return tuple(r for r in found if r is not None)


def _laws(
    damper: CardDamper,
    table: Tabled,
    gains: Gains,
    order: Order,
    plant: Plant,
    base: BaseMotion,
    ends: tuple[float, float],
) -> dict[str, tuple[Change, ...]]:
    """Changes where one law of the lumped model is warm at a time."""
    families = [family(name, table, gains, (SHOWN[name],)) for name in order.controllers]
    steps = stacked(one_law_at_a_time(damper, *ends))
    sensor = damper.gas.sensor()
    return changes_by_law(conflict_diagram(plant, families, steps, CASES, base, sensor=sensor))


def _drawn(
    dampers: Sequence[CardDamper],
    families: Sequence[Family],
    temperatures: Sequence[float],
    plant: Plant,
    base: BaseMotion,
) -> tuple[Drawn, ...]:
    """Curves of drawn dampers beside that of the card's own, which comes first.

    The controllers are the card's, and so is the gas, which the plant holds.
    """
    steps = stacked([d.step(t) for d in dampers for t in temperatures])
    names = [f"{k} at {t:g} °C" for k in range(len(dampers)) for t in temperatures]
    found = conflict_diagram(plant, families, steps, names, base, sensor=dampers[0].gas.sensor())
    return tuple(_over(c, len(temperatures)) for c in found.curves)


def _over(curve: Curve, ends: int) -> Drawn:
    def ratios(runs: np.ndarray) -> tuple[Over, np.ndarray]:
        """Over the card's own; and warm over cold at the set point that is told."""
        by = runs.reshape(len(curve.set_points), -1, ends, runs.shape[2])
        over = np.mean(by[:, 1:] / by[:, :1], axis=3).swapaxes(1, 2)
        at = by[nearest(curve.set_points, SHOWN[curve.name]), 1:]
        return over, np.mean(at[:, -1] / at[:, 0], axis=1)

    (acceleration, warm_acceleration), (space, warm_space) = (
        ratios(z) for z in (curve.acceleration, curve.working_space)
    )
    changes = () if ends == 1 else (band(warm_acceleration - 1.0), band(warm_space - 1.0))
    return Drawn(curve.name, curve.set_points, curve.unit, acceleration, space, changes)
