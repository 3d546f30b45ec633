"""Which cards an isolator can run, and the dampers that they are."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import jax.numpy as jnp
import numpy as np

from sysid.cards.export.pieces import LEAKS, WITHOUT_SAY, remembers
from sysid.cards.idle import NEED_TEMPERATURE
from sysid.cards.schema import Card
from sysid.cards.verify import verify
from sysid.data.supply import same_current
from sysid.effects.base import (
    AbstractDriveEffect,
    AbstractEffect,
    AbstractForceEffect,
    AbstractLawEffect,
)
from sysid.effects.drive.coil_lag import CoilLag
from sysid.effects.force.gas_spring import GasSpring
from sysid.effects.force.presliding_friction import PreslidingFriction
from sysid.effects.force.stribeck_friction import StribeckFriction
from sysid.effects.law.frequency_law import FrequencyLaw
from sysid.effects.motion.series_compliance import SeriesCompliance
from sysid.errors import CardError
from sysid.isolator.damper_step import AbstractDamperStep
from sysid.isolator.element_memory import ElementMemory
from sysid.isolator.fractional_power import fractional_power
from sysid.isolator.frequency_dependent import frequency_dependent
from sysid.isolator.gas import Gas
from sysid.isolator.hysteretic_memory import Hysteresis, SeriesHysteresis
from sysid.isolator.lumped_step import LumpedStep, lumped_step_at
from sysid.isolator.memory import AbstractMemory, Bristle
from sysid.isolator.pointwise_step import PointwiseStep
from sysid.isolator.study import stacked
from sysid.models.base import AbstractValve
from sysid.models.bouc_wen import BoucWen
from sysid.models.dahl import Dahl
from sysid.models.damper import Damper
from sysid.models.lumped import TABLE_1, Lumped, Warmth
from sysid.models.modified_bouc_wen import ModifiedBoucWen
from sysid.parameters import as_dict, build

POINTWISE: Final = ("generalized", "tanh", "carreau")
"""Models whose force is a function of what happens at an instant."""
HYSTERETIC: Final = ("dahl", "bouc_wen", "modified_bouc_wen")
"""Models whose force is one of that and of a state that follows the travel."""
SUPPORTED: Final = ("lumped", *POINTWISE, *HYSTERETIC)
"""Models of cards."""
LAG: Final = TABLE_1["tau"]
"""s, of current and fluid where a card has none of its own: that of BS09."""
NO_STEP: Final = "nobody wrote how it advances with a plant"
"""Why other models are refused."""
FOLLOWED: Final = (PreslidingFriction, StribeckFriction)
"""Effects whose state the step carries."""
TABLED: Final = 9
"""Currents of the table of a damper that has none of its own."""
Hysteretic: TypeAlias = Dahl | BoucWen | ModifiedBoucWen


@dataclass(frozen=True)
class CardDamper:
    """A card as an isolator needs it.

    Attributes:
        valve: The model, without a static force.
        effects: On its laws and in parallel, without memory.
        drives: On its current.
        tau: Of current and fluid, s.
        currents: A, at which gain scheduling reads its table; the last one is the largest.
        warm: Its force depends on temperature.
        gas: Its gas spring, and the static force that the model itself has.
        left_out: Effects of the card that have no say here, or another one, each with the reason.
        bristles: What friction beside the model remembers.
        per_decade: ε of its law of frequency, on the whole force of the valve; None without one.
    """

    valve: AbstractValve
    effects: tuple[AbstractEffect, ...]
    drives: tuple[AbstractDriveEffect, ...]
    tau: float
    currents: tuple[float, ...]
    warm: bool
    gas: Gas
    left_out: tuple[str, ...]
    bristles: tuple[AbstractMemory, ...] = ()
    per_decade: float | None = None

    @property
    def lumped(self) -> Lumped | None:
        """The lumped model, where it is one."""
        return self.valve if isinstance(self.valve, Lumped) else None

    def step(self, temperature: float) -> AbstractDamperStep:
        """The damper in a closed loop, at a temperature, °C."""
        if self.lumped is None or self.effects or self.drives or self.bristles:
            return self._pointwise(temperature)
        return self._alone(self.lumped, _everywhere(temperature))

    def step_at(self, valve: Lumped, temperature: float, warmth: Warmth) -> AbstractDamperStep:
        """The damper with another lumped model in it, whose laws are read at their own °C.

        Args:
            valve: The model.
            temperature: Of all else, °C.
            warmth: Of its laws, °C.
        """
        if self.effects or self.drives or self.bristles:
            return self._pointwise(temperature, valve, warmth)
        return self._alone(valve, warmth)

    def table_from(self, temperature: float) -> LumpedStep | PointwiseStep:
        """What gain scheduling reads its table from: where frequency matters, at 1 Hz.

        Args:
            temperature: °C.
        """
        step = self.step(temperature)
        inner = getattr(step, "inner", step)
        assert isinstance(inner, LumpedStep | PointwiseStep)
        return inner

    def at(self, temperatures: Sequence[float]) -> AbstractDamperStep:
        """The damper at some temperatures, °C, one module with them in front."""
        return stacked([self.step(t) for t in temperatures])

    def _alone(self, valve: Lumped, warmth: Warmth) -> AbstractDamperStep:
        step = lumped_step_at(valve, *warmth)
        return step if self.per_decade is None else frequency_dependent(step, self.per_decade)

    def _pointwise(
        self, temperature: float, valve: Lumped | None = None, warmth: Warmth | None = None
    ) -> PointwiseStep:
        model = self.valve if valve is None else valve
        beside = self.effects
        if isinstance(model, Lumped):
            inside = tuple(e for e in self.effects if not isinstance(e, AbstractForceEffect))
            beside = tuple(e for e in self.effects if isinstance(e, AbstractForceEffect))
            own: tuple[AbstractMemory, ...] = (ElementMemory(model, inside, warmth),)
        else:
            laws = tuple(e for e in self.effects if isinstance(e, AbstractLawEffect))
            own = memories_of(model, laws)
        return PointwiseStep(
            damper=Damper(model, beside), tau=jnp.asarray(self.tau),
            temperature=jnp.asarray(float(temperature)), currents=self.currents,
            drives=self.drives, memories=(*own, *self.bristles),
            sided=not isinstance(model, Hysteretic | Lumped),
            power=None if self.per_decade is None else fractional_power(self.per_decade),
        )  # fmt: skip


def damper_of_card(card: Card, *, where: str = "card") -> CardDamper:
    """The damper of a card, if an isolator can run it.

    Effects on the recorder's channel are no force on the mass and are left out; a gas spring is
    taken, and so are effects without memory, friction that bends before it slides, and a law of
    frequency of the whole force.  A coil's lag takes the place of the usual one; the lumped model
    has one already.  Beside the lumped model, which takes them into its equations, a leak and a
    spring are taken, too.  All others are refused by name.  The static force of a model is carried
    by the isolator's spring, as a gas's.

    Raises:
        CardError: A model or an effect that is not supported, or one current only: what the
            supply or its meter scatters by (`same_current`) is no second one.
    """
    damper = verify(card, where=where)
    if card.model not in SUPPORTED:
        raise CardError(
            f"an isolator cannot run model {card.model!r}: {NO_STEP}",
            where=f"{where}, model",
            advice=f"Supported: {', '.join(SUPPORTED)}; fit one with `sysid fit --model lumped`",
        )
    valve = damper.valve
    known = valve.currents if isinstance(valve, Lumped) else card.validity.current
    low, high = min(known), max(known)
    if high - low <= same_current(max(abs(low), abs(high))):
        raise CardError(
            "a damper known at one current cannot be controlled",
            where=where,
            advice="Fit tests at two currents or more",
        )
    lumped = isinstance(valve, Lumped)
    tau, stiffness, left_out, per_decade = LAG, 0.0, [], None
    kept: list[AbstractEffect] = []
    drives: list[AbstractDriveEffect] = []
    bristles: list[AbstractMemory] = []
    refused: dict[str, list[str]] = {}
    for effect in damper.effects:
        id = effect.facts.id
        if isinstance(effect, GasSpring):
            stiffness += float(effect.k_g)
        elif effect.stage == "channel":
            left_out.append(f"{id} is the recorder's, no force on the mass")
        elif isinstance(effect, CoilLag) and not lumped:
            tau = float(effect.tau_i)
        elif isinstance(effect, FrequencyLaw) and effect.part == "whole" and per_decade is None:
            per_decade = float(effect.eps_f)
            left_out.append(f"{id} is defined for cycles; it stands as a filter of the force")
        elif id in WITHOUT_SAY:
            left_out.append(f"{id}: {WITHOUT_SAY[id]}")
        elif isinstance(effect, FOLLOWED):
            bristles.append(Bristle(effect))
        elif why := why_not(effect, damper if lumped else None):
            refused.setdefault(why, []).append(id)
        elif isinstance(effect, AbstractDriveEffect):
            drives.append(effect)
        else:
            kept.append(effect)
    if refused:
        raise CardError(
            f"an isolator cannot run {_listed(refused)}",
            where=f"{where}, effects",
            advice="Supported: gas_spring; effects of stage 'channel', which are left out; effects "
            "without memory, presliding and Stribeck friction. Give the base card",
        )
    preload, currents = 0.0, tuple(np.linspace(0.0, high, TABLED).tolist())
    if isinstance(valve, Lumped):
        tau, currents = float(valve.tau), valve.currents
    else:
        valve, preload = without_static(valve)
    return CardDamper(
        valve=valve,
        effects=tuple(kept),
        drives=tuple(drives),
        tau=tau,
        currents=currents,
        warm=lumped or any(effect.facts.id in NEED_TEMPERATURE for effect in kept),
        gas=Gas(preload, stiffness),
        left_out=tuple(left_out),
        bristles=tuple(bristles),
        per_decade=per_decade,
    )


def alone(valve: Lumped) -> CardDamper:
    """The lumped model with nothing beside it."""
    return CardDamper(
        valve=valve, effects=(), drives=(), tau=float(valve.tau), currents=valve.currents,
        warm=True, gas=Gas(), left_out=(),
    )  # fmt: skip


def without_static(valve: AbstractValve) -> tuple[AbstractValve, float]:
    """A model without its force at the centre, and that force, N."""
    symbols = as_dict(valve)
    if "f_0" not in symbols:
        return valve, 0.0
    return build(valve, symbols | {"f_0": 0.0}), symbols["f_0"]


def memories_of(
    valve: AbstractValve, laws: tuple[AbstractEffect, ...] = ()
) -> tuple[AbstractMemory, ...]:
    """What a model with a state that follows the travel remembers; nothing of all others.

    Args:
        valve: The model.
        laws: That change its numbers.
    """
    if isinstance(valve, Dahl | BoucWen):
        return (Hysteresis(valve, laws),)
    if isinstance(valve, ModifiedBoucWen):
        return (SeriesHysteresis(valve, laws),)
    return ()


def why_not(effect: AbstractEffect, beside: Damper | None = None) -> str:
    """Why the step cannot have an effect; empty where it can.

    Args:
        effect: The effect.
        beside: The damper that it belongs to, where its model is the lumped one.
    """
    id = effect.facts.id
    if id == "surface_temperature":
        return "it needs the mean power of a whole record"
    if beside is not None:
        if isinstance(effect, CoilLag):
            return "the lumped model has a lag of the current already"
        if isinstance(effect, SeriesCompliance):
            return _why_no_spring(beside)
        if id == "bypass_leakage":
            return ""
    if remembers(effect) and not isinstance(effect, FOLLOWED):
        return "the force depends on what came before, and the step keeps no state of it"
    if id in LEAKS or effect.stage == "motion":
        return "the valve moves otherwise than the piston, which the step does not solve for"
    return ""


def _why_no_spring(damper: Damper) -> str:
    """A spring is taken into the lumped model's own; forces between the two are not solved for."""
    if any(isinstance(e, AbstractForceEffect) for e in damper.effects):
        return "forces stand between it and the mass of the lumped model"
    return ""


def _listed(refused: Mapping[str, Sequence[str]]) -> str:
    """Effects by name, and why."""
    told = [f"{', '.join(map(repr, ids))} ({why})" for why, ids in refused.items()]
    return f"effect {'; '.join(told)}"


def _everywhere(temperature: float) -> Warmth:
    """One temperature, °C, for C_post, F_y and k."""
    at = jnp.asarray(float(temperature))
    return Warmth(at, at, at)


def at_temperatures(valve: Lumped, temperatures: Sequence[float]) -> LumpedStep:
    """The lumped model at some temperatures, °C, one module with them in front."""
    return stacked([lumped_step_at(valve, *_everywhere(t)) for t in temperatures])
