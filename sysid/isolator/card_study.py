"""Everything that is asked of a card in an isolator, in one result."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import jax.numpy as jnp
import numpy as np

from sysid.cards.schema import Card
from sysid.errors import CardError
from sysid.isolator.base_motion import BaseMotion, butterworth_motion, road_motion
from sysid.isolator.compare import Band, Change, Rival, band, change, rival
from sysid.isolator.families import (
    CONTROLLED,
    DAMPINGS,
    Family,
    Gains,
    Name,
    family,
)
from sysid.isolator.from_card import CardDamper, at_temperatures, damper_of_card, drawn_valves
from sysid.isolator.hardware_in_loop import Actuator, rig_isolator
from sysid.isolator.lumped_step import LumpedStep, lumped_step
from sysid.isolator.plant import Plant, mass_isolator
from sysid.isolator.quarter_car import SPRING, quarter_car
from sysid.isolator.sensitivity import CASES, changes_by_law, one_law_at_a_time
from sysid.isolator.study import ConflictDiagram, Curve, conflict_diagram, ideal_curve, stacked
from sysid.isolator.tuning import Ultimate, search_feedback, ultimate

PlantName = Literal["mass", "quarter-car"]
MOTIONS: Final = 20
TEMPERATURES: Final = 7
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
        draws: Dampers drawn from the card's covariance; 0 for none.
        duration: Of each motion, s.
        seed: Of the first motion; the others have the numbers after it.
        tune: Find gains for this damper, instead of the paper's.
    """

    plant: PlantName = "mass"
    controllers: tuple[Name, ...] = CONTROLLED
    motions: int = MOTIONS
    draws: int = MOTIONS
    duration: float = 5.0
    seed: int = 1
    tune: bool = False


@dataclass(frozen=True)
class Drawn:
    """A change from cold to warm with the card's uncertainty in it.

    Attributes:
        name: Of the controller.
        acceleration: Over draws, each the mean over motions: the card's share of the uncertainty.
        working_space: The same.
    """

    name: str
    acceleration: Band
    working_space: Band


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
        drawn: The changes with the card's uncertainty; empty without draws.
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
        card: Of a lumped model.
        order: What is asked.
        where: Its file, for errors.
        say: Told what is under way.

    Raises:
        CardError: The card cannot be run (`damper_of_card`).
        DataError: No such motions, or no table for gain scheduling.
    """
    damper = damper_of_card(card, where=where)
    temperatures = _temperatures(card, where)
    plant, base = _plant(order, damper), _base(order)
    gains, found_ultimate = Gains(temperature=temperatures[0]), None
    if order.tune:
        say("tuning")
        gains, found_ultimate = _tuned(damper, gains, plant, base)
    families = [family(name, damper.valve, gains) for name in order.controllers]
    fastest = card.validity.velocity[1]
    say("conflict diagram")
    all_families = [*families, family("passive", damper.valve, set_points=(0.0,))]
    found = conflict_diagram(
        plant, all_families, at_temperatures(damper.valve, temperatures),
        [f"{t:g} °C" for t in temperatures], base, sensor=damper.gas.sensor(), fastest=fastest,
    )  # fmt: skip
    diagram = ConflictDiagram(found.variants, found.motion, found.curves[:-1])
    ends = (0, len(temperatures) - 1)[: len(temperatures)]
    laws, drawn, rig = {}, (), None
    if len(temperatures) > 1:
        say("one law at a time, and draws")
        laws, drawn = _varied(card, damper, gains, order, plant, base, temperatures)
    if order.plant == "mass":
        say("simulated rig")
        rig = conflict_diagram(
            rig_isolator(RIG), families,
            at_temperatures(damper.valve, [temperatures[k] for k in ends]),
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
        rig=rig,
        rig_rivals=() if rig is None else tuple(_rivals(rig, k) for k in range(len(ends))),
        beyond=max(float(c.beyond.mean(axis=2).max()) for c in diagram.curves),
        fastest=fastest,
        left_out=damper.left_out,
    )


def _temperatures(card: Card, where: str) -> tuple[float, ...]:
    box = card.validity.temperature
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
    cold = lumped_step(damper.valve, jnp.asarray(gains.temperature))
    oscillates = ultimate(cold)
    feedback, feedforward = search_feedback(plant, cold, base, SHOWN["P"]).best
    tuned = replace(gains, feedback=feedback, feedforward=feedforward, pid=oscillates.pid)
    return tuned, oscillates


def _rivals(diagram: ConflictDiagram, variant: int) -> tuple[Rival, ...]:
    first = diagram.curves[0].name
    found = (rival(diagram, c.name, first, variant) for c in diagram.curves[1:])
    return tuple(r for r in found if r is not None)


def _varied(
    card: Card,
    damper: CardDamper,
    gains: Gains,
    order: Order,
    plant: Plant,
    base: BaseMotion,
    temperatures: Sequence[float],
) -> tuple[dict[str, tuple[Change, ...]], tuple[Drawn, ...]]:
    """Laws warm one at a time, and drawn dampers cold and warm, in one compiled program."""
    cold, warm = temperatures[0], temperatures[-1]
    families: list[Family] = [
        family(name, damper.valve, gains, (SHOWN[name],)) for name in order.controllers
    ]
    steps: list[LumpedStep] = one_law_at_a_time(damper.valve, cold, warm)
    drawn = drawn_valves(card, damper.valve, order.draws, order.seed) if order.draws else []
    steps += [lumped_step(v, jnp.asarray(t)) for v in drawn for t in (cold, warm)]
    names = [*CASES, *(f"draw {k}" for k in range(2 * len(drawn)))]
    found = conflict_diagram(plant, families, stacked(steps), names, base)
    return changes_by_law(found), tuple(_drawn(c) for c in found.curves) if drawn else ()


def _drawn(curve: Curve) -> Drawn:
    first = len(CASES)

    def ratios(runs: np.ndarray) -> Band:
        pairs = runs[0, first:].reshape(-1, 2, runs.shape[2])
        return band(np.mean(pairs[:, 1] / pairs[:, 0], axis=1) - 1.0)

    return Drawn(curve.name, ratios(curve.acceleration), ratios(curve.working_space))
