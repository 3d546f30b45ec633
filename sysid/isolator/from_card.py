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
from sysid.effects.base import AbstractEffect, AbstractLawEffect
from sysid.effects.drive.coil_lag import CoilLag
from sysid.effects.force.gas_spring import GasSpring
from sysid.effects.force.presliding_friction import PreslidingFriction
from sysid.effects.force.stribeck_friction import StribeckFriction
from sysid.errors import CardError
from sysid.isolator.damper_step import AbstractDamperStep
from sysid.isolator.gas import Gas
from sysid.isolator.hysteretic_memory import Hysteresis, SeriesHysteresis
from sysid.isolator.lumped_step import LumpedStep, lumped_step
from sysid.isolator.memory import AbstractMemory, Bristle
from sysid.isolator.pointwise_step import PointwiseStep
from sysid.isolator.study import stacked
from sysid.models.base import AbstractValve
from sysid.models.bouc_wen import BoucWen
from sysid.models.dahl import Dahl
from sysid.models.damper import Damper
from sysid.models.lumped import TABLE_1, Lumped
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
Hysteretic: TypeAlias = Dahl | BoucWen | ModifiedBoucWen
_SOUND: Final = 0.5
"""Largest share of draws that may make no damper before they are refused."""


@dataclass(frozen=True)
class CardDamper:
    """A card as an isolator needs it.

    Attributes:
        model: The lumped model, or another with its effects without memory.
        tau: Of current and fluid, s.
        largest_current: A.
        warm: Its force depends on temperature.
        gas: Its gas spring, and the static force that the model itself has.
        left_out: Effects of the card that have no say here, each with the reason.
        memories: What the model and friction beside it remember.
    """

    model: Lumped | Damper
    tau: float
    largest_current: float
    warm: bool
    gas: Gas
    left_out: tuple[str, ...]
    memories: tuple[AbstractMemory, ...] = ()

    @property
    def lumped(self) -> Lumped | None:
        """The lumped model, where it is one."""
        return self.model if isinstance(self.model, Lumped) else None

    def step(self, temperature: float) -> AbstractDamperStep:
        """The damper in a closed loop, at a temperature, °C."""
        at = jnp.asarray(float(temperature))
        if isinstance(self.model, Lumped):
            return lumped_step(self.model, at)
        return PointwiseStep(
            damper=self.model, tau=jnp.asarray(self.tau), temperature=at,
            largest_current=self.largest_current, memories=self.memories,
            sided=not isinstance(self.model.valve, Hysteretic),
        )  # fmt: skip

    def table_from(self, temperature: float) -> Lumped | PointwiseStep:
        """What gain scheduling reads its table from.

        Args:
            temperature: °C.
        """
        step = self.step(temperature)
        if isinstance(self.model, Lumped):
            return self.model
        assert isinstance(step, PointwiseStep)
        return step

    def at(self, temperatures: Sequence[float]) -> AbstractDamperStep:
        """The damper at some temperatures, °C, one module with them in front."""
        return stacked([self.step(t) for t in temperatures])


def damper_of_card(card: Card, *, where: str = "card") -> CardDamper:
    """The damper of a card, if an isolator can run it.

    Effects on the recorder's channel are no force on the mass and are left out; a gas spring is
    taken; beside all other models than the lumped one so are effects without memory and friction
    that bends before it slides, and a coil's lag takes the place of the usual one.  All others are
    refused by name.  The static force of a model is carried by the isolator's spring, as a gas's.

    Raises:
        CardError: A model or an effect that is not supported, or one current only.
    """
    damper = verify(card, where=where)
    if card.model not in SUPPORTED:
        raise CardError(
            f"an isolator cannot run model {card.model!r}: {NO_STEP}",
            where=f"{where}, model",
            advice=f"Supported: {', '.join(SUPPORTED)}; fit one with `sysid fit --model lumped`",
        )
    valve = damper.valve
    low, high = card.validity.current
    if len(valve.currents) < 2 if isinstance(valve, Lumped) else not high > low:
        raise CardError(
            "a damper known at one current cannot be controlled",
            where=f"{where}, parameters",
            advice="Fit tests at two currents or more",
        )
    tau, stiffness, left_out = LAG, 0.0, []
    kept: list[AbstractEffect] = []
    bristles: list[AbstractMemory] = []
    refused: dict[str, list[str]] = {}
    for effect in damper.effects:
        id = effect.facts.id
        if isinstance(effect, GasSpring):
            stiffness += float(effect.k_g)
        elif effect.stage == "channel":
            left_out.append(f"{id} is the recorder's, no force on the mass")
        elif isinstance(valve, Lumped):
            refused.setdefault("the lumped model is stepped alone", []).append(id)
        elif isinstance(effect, CoilLag):
            tau = float(effect.tau_i)
        elif id in WITHOUT_SAY:
            left_out.append(f"{id}: {WITHOUT_SAY[id]}")
        elif isinstance(effect, FOLLOWED):
            bristles.append(Bristle(effect))
        elif why := why_not(effect):
            refused.setdefault(why, []).append(id)
        else:
            kept.append(effect)
    if refused:
        raise CardError(
            f"an isolator cannot run {_listed(refused)}",
            where=f"{where}, effects",
            advice="Supported: gas_spring; effects of stage 'channel', which are left out; beside "
            "other models, effects without memory, presliding and Stribeck friction. Give the base "
            "card",
        )
    said = tuple(left_out)
    if isinstance(valve, Lumped):
        gas = Gas(0.0, stiffness)
        return CardDamper(valve, float(valve.tau), valve.currents[-1], True, gas, said)
    valve, preload = without_static(valve)
    lawful = any(isinstance(effect, AbstractLawEffect) for effect in kept)
    return CardDamper(
        model=Damper(valve, tuple(kept)),
        tau=tau,
        largest_current=high,
        warm=any(effect.facts.id in NEED_TEMPERATURE for effect in kept),
        gas=Gas(preload, stiffness),
        left_out=said,
        memories=(*memories_of(valve, lawful=lawful), *bristles),
    )


def without_static(valve: AbstractValve) -> tuple[AbstractValve, float]:
    """A model without its force at the centre, and that force, N."""
    symbols = as_dict(valve)
    if "f_0" not in symbols:
        return valve, 0.0
    return build(valve, symbols | {"f_0": 0.0}), symbols["f_0"]


def memories_of(valve: AbstractValve, *, lawful: bool) -> tuple[AbstractMemory, ...]:
    """What a model remembers; nothing where its force is a function of the instant.

    Args:
        valve: The model.
        lawful: Laws act on its parts.
    """
    if isinstance(valve, Dahl | BoucWen):
        return (Hysteresis(valve),)
    if isinstance(valve, ModifiedBoucWen):
        return (SeriesHysteresis(valve, lawful),)
    return ()


def why_not(effect: AbstractEffect) -> str:
    """Why the step of all models but the lumped one cannot have an effect; empty where it can."""
    id = effect.facts.id
    if id == "surface_temperature":
        return "it needs the mean power of a whole record"
    if remembers(effect) and not isinstance(effect, FOLLOWED):
        return "the force depends on what came before, and the step keeps no state of it"
    if id in LEAKS or effect.stage == "motion":
        return "the valve moves otherwise than the piston, which the step does not solve for"
    return ""


def _listed(refused: Mapping[str, Sequence[str]]) -> str:
    """Effects by name, and why."""
    told = [f"{', '.join(map(repr, ids))} ({why})" for why, ids in refused.items()]
    return f"effect {'; '.join(told)}"


def at_temperatures(valve: Lumped, temperatures: Sequence[float]) -> LumpedStep:
    """The lumped model at some temperatures, °C, one module with them in front."""
    return stacked([lumped_step(valve, jnp.asarray(float(t))) for t in temperatures])


def drawn_valves(card: Card, valve: Lumped, count: int, seed: int) -> list[Lumped]:
    """Dampers that the card's covariance allows, normal draws about its values.

    Args:
        card: With a covariance.
        valve: Its model.
        count: How many.
        seed: Of the draws.

    Raises:
        CardError: It has no covariance, or it is too wide to draw from.
    """
    known = as_dict(valve)
    symbols = [s for s in card.covariance.symbols if s in known]
    if not symbols:
        raise CardError(
            "has no covariance, so nothing can be drawn from it",
            advice="Leave --draws out, or give a card that `sysid fit` wrote",
        )
    chosen = [card.covariance.symbols.index(s) for s in symbols]
    matrix = np.asarray(card.covariance.matrix)[np.ix_(chosen, chosen)]
    values, vectors = np.linalg.eigh(matrix)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    rng = np.random.default_rng(seed)
    found: list[Lumped] = []
    for _ in range(round(count / _SOUND)):
        moved = root @ rng.standard_normal(len(symbols))
        numbers = dict(known)
        for symbol, change in zip(symbols, moved, strict=True):
            numbers[symbol] = known[symbol] + float(change)
        if min(numbers[s] for s in ("C_pre", "m_l", "tau")) > 0.0:
            found.append(build(Lumped, numbers))
        if len(found) == count:
            return found
    raise CardError(
        "its covariance is so wide that most draws are no dampers",
        advice="Leave --draws out, or fit more tests",
    )
