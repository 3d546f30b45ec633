"""The pieces that an exported damper is made of, and what cannot be exported, by name."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Final, Literal

import equinox as eqx
import numpy as np

from sysid.cards.models import effect_prefixes
from sysid.effects.base import AbstractEffect
from sysid.effects.motion.series_compliance import SeriesCompliance
from sysid.errors import CardError
from sysid.models.base import AbstractInnerValve, AbstractValve
from sysid.models.damper import Damper
from sysid.parameters import ParamSpec

Memory = Literal["none", "past", "line"]
Stage = Literal["drive", "motion", "law", "leak", "force", "channel", "valve"]

WITHOUT_SAY: Final[Mapping[str, str]] = {
    "magnetic_hysteresis": "a simulated motion does not tell how the current came before it",
    "first_cycle_breakaway": "a simulated motion does not count cycles since a rest",
    "self_heating": "its cycles are those of a test; give the temperature of the oil as input",
    "run_drift": "a simulated motion has no place in a campaign",
    "frequency_law": "a motion that is no cycle has no frequency",
    "waveform_distortion": "it is the test rig's; a simulated motion is taken as it is",
}
"""Effects that are nothing on a motion that is no steady cycle, here and in `sysid simulate`."""

DELAYS: Final[Mapping[str, str]] = {"force_delay": "tau_F", "velocity_delay": "tau_v"}
"""Id → parameter that is a time by which something is late."""

MEMORY: Final[Mapping[str, Memory]] = {
    "coil_lag": "past",
    "velocity_delay": "line",
    "backlash_held": "past",
    "backlash_loose": "past",
    "entrained_air": "past",
    "seating_leakage": "past",
    "presliding_friction": "past",
    "stribeck_friction": "past",
    "force_delay": "line",
    "force_filter_one": "past",
    "force_filter_two": "past",
    "dahl": "past",
    "bouc_wen": "past",
    "modified_bouc_wen": "past",
    "lumped": "past",
}
"""Pieces that remember: a state, or a line of past samples."""

BEHIND_NO_SPRING: Final[Mapping[str, str]] = {
    "series_compliance": "two springs are one, whose compliance is the sum",
    "velocity_delay": "the spring would be solved for with a velocity that is not known yet",
    "backlash_loose": "its force jumps where contact ends, and the spring's equation has no root",
    "displacement_zero": "the peak speed follows from the acceleration that the spring leaves",
    "width_law_whole": "the width jumps with the acceleration that the spring leaves",
    "width_law_yield": "the width jumps with the acceleration that the spring leaves",
}
"""Effects between a spring and the valve for which the spring's force is not determined."""

LEAKS: Final = ("bypass_leakage", "seating_leakage")
NEEDS: Final[Mapping[str, tuple[str, ...]]] = {
    "smooth_sign": (
        "seal_friction", "position_friction", "guide_friction",
        "asymmetric_gain_velocity",
    ),
    "warmth": (
        "viscosity_temperature", "yield_temperature", "stiffness_temperature", "gas_temperature",
        "lumped",
    ),
    "bristle": ("presliding_friction", "stribeck_friction"),
    "travel": ("backlash_held", "backlash_loose", "entrained_air", "seating_leakage"),
    "lag": ("coil_lag", "force_filter_one", "lumped"),
    "delay_line": ("velocity_delay", "force_delay"),
    "current_law": ("tanh", "dahl", "bouc_wen", "modified_bouc_wen"),
    "bouc_wen_flow": ("dahl", "bouc_wen", "modified_bouc_wen"),
    "series_element": ("dahl", "bouc_wen", "modified_bouc_wen"),
}  # fmt: skip
"""Shared source → the pieces that need it."""

FORM_OF: Final[Mapping[str, str]] = {
    "asymmetric_gain": "turns",
    "backlash": "joint",
    "force_filter": "poles",
    "width_law": "part",
}
"""Effects whose forms have a source each, and the field that tells the form."""
FORMS: Final[Mapping[str, tuple[str, str]]] = {
    "side": ("1 in compression, -1 in rebound", "-"),
    "mains": ("frequency of the mains", "Hz"),
    "currents": ("currents of the tables", "A"),
}
"""Numbers that are not parameters but belong to the form of a piece: name and unit."""


@dataclass(frozen=True)
class Number:
    """A parameter of a piece.

    Attributes:
        field: Its name in the source.
        symbol: Its symbol in the card.
        name: In words.
        unit: SI.
        value: In that unit; many for a table over current.
    """

    field: str
    symbol: str
    name: str
    unit: str
    value: float | tuple[float, ...]


@dataclass(frozen=True)
class Piece:
    """A valve or an effect.

    Attributes:
        kind: Name of its source.
        member: Name of this one in the exported damper; ids may stand there twice.
        stage: Where it acts.
        numbers: Its parameters.
        memory: What it keeps from sample to sample.
    """

    kind: str
    member: str
    stage: Stage
    numbers: tuple[Number, ...]
    memory: Memory

    @property
    def currents(self) -> tuple[float, ...]:
        """A, of its tables; none where it has no tables."""
        values = [n.value for n in self.numbers if n.field == "currents"]
        return values[0] if values and isinstance(values[0], tuple) else ()


@dataclass(frozen=True)
class Pieces:
    """A damper, piece by piece, in the order in which they act.

    Attributes:
        valve: The model.
        drive: On the current.
        motion: Between the rod and the valve, the first nearest to the rod.
        laws: On the valve.
        leaks: Beside it.
        forces: In parallel.
        channel: Between force and what is recorded.
        inner: The valve takes leaks and springs into its own equations.
        gas: The valve has a gas force beside its parts.
        without_say: Sentences on effects that are nothing on simulated motions.
    """

    valve: Piece
    drive: tuple[Piece, ...]
    motion: tuple[Piece, ...]
    laws: tuple[Piece, ...]
    leaks: tuple[Piece, ...]
    forces: tuple[Piece, ...]
    channel: tuple[Piece, ...]
    inner: bool
    gas: bool
    without_say: tuple[str, ...]

    @property
    def own_spring(self) -> Piece | None:
        """The spring that the valve takes into its equations, where it does."""
        springs = [p for p in self.motion if p.kind == "series_compliance"]
        return springs[0] if self.inner and springs else None

    @property
    def all(self) -> tuple[Piece, ...]:
        """The valve, then all effects from the current to the channel."""
        effects = (
            *self.drive, *self.motion, *self.laws, *self.leaks, *self.forces, *self.channel,
        )  # fmt: skip
        return (self.valve, *effects)


def pieces_of(damper: Damper, model: str, *, where: str = "card") -> Pieces:
    """Take a damper apart.

    Args:
        damper: From a card.
        model: Name of its valve model in cards.
        where: The card's file, for errors.

    Raises:
        CardError: It has an effect that cannot be computed sample by sample, or a combination
            that no source here has.
    """
    _refuse(damper, where)
    staged: dict[str, list[Piece]] = {
        z: [] for z in ("drive", "motion", "law", "leak", "force", "channel")
    }
    taken: dict[str, int] = {}
    told = []
    prefixes = effect_prefixes([effect.facts.id for effect in damper.effects])
    for effect, prefix in zip(damper.effects, prefixes, strict=True):
        id = effect.facts.id
        if id in WITHOUT_SAY:
            told.append(f"{id} is not part of it: {WITHOUT_SAY[id]}")
            continue
        kind = _kind(effect)
        taken[kind] = taken.get(kind, 0) + 1
        member = kind if taken[kind] == 1 else f"{kind}_{taken[kind]}"
        stage: Stage = "leak" if id in LEAKS else effect.stage
        piece = Piece(kind, member, stage, _numbers(effect, prefix), MEMORY.get(kind, "none"))
        staged[stage].append(piece)
    valve = Piece(model, model, "valve", _numbers(damper.valve, ""), MEMORY.get(model, "none"))
    return Pieces(
        valve=valve,
        drive=tuple(staged["drive"]),
        motion=tuple(staged["motion"]),
        laws=tuple(staged["law"]),
        leaks=tuple(staged["leak"]),
        forces=tuple(staged["force"]),
        channel=tuple(staged["channel"]),
        inner=isinstance(damper.valve, AbstractInnerValve),
        gas=type(damper.valve).gas_force is not AbstractValve.gas_force,
        without_say=tuple(told),
    )


def remembers(effect: AbstractEffect) -> bool:
    """Whether an effect, in the form that it has, keeps a state or past samples (`MEMORY`)."""
    return _kind(effect) in MEMORY


def shared_sources(pieces: Pieces) -> tuple[str, ...]:
    """Names of the shared sources that the pieces need, in order."""
    kinds = {piece.kind for piece in pieces.all}
    return tuple(name for name, users in NEEDS.items() if kinds & set(users))


def _kind(effect: AbstractEffect) -> str:
    """Name of an effect's source: its id, with its form where forms differ."""
    form = FORM_OF.get(effect.facts.id)
    return effect.facts.id if form is None else f"{effect.facts.id}_{getattr(effect, form)}"


def _numbers(module: eqx.Module, prefix: str) -> tuple[Number, ...]:
    found = []
    for field in fields(module):
        spec: ParamSpec | None = field.metadata.get("param")
        if spec is None:
            continue
        value = np.asarray(getattr(module, field.name), dtype=np.float64)
        number = float(value) if value.ndim == 0 else tuple(float(z) for z in value)
        found.append(Number(field.name, f"{prefix}{spec.symbol}", spec.name, spec.unit, number))
    for name, (told, unit) in FORMS.items():
        if hasattr(module, name):
            form = getattr(module, name)
            number = tuple(map(float, form)) if isinstance(form, tuple) else float(form)
            found.append(Number(name, f"{prefix}{name}", told, unit, number))
    return tuple(found)


def _refuse(damper: Damper, where: str) -> None:
    ids = [effect.facts.id for effect in damper.effects]
    if "surface_temperature" in ids:
        raise CardError(
            "surface_temperature cannot be exported: it needs the mean power of the whole record",
            where=where,
            advice="Leave it out of the card, or give the oil's temperature as input",
        )
    for effect in damper.effects:
        early = DELAYS.get(effect.facts.id)
        if early is not None and float(getattr(effect, early)) < 0.0:
            raise CardError(
                f"{effect.facts.id} cannot be exported: {early} is negative, and samples that are "
                "still to come are not known",
                where=where,
                advice="Leave it out of the card, or move the recorded motion in time",
            )
    springs = [k for k, e in enumerate(damper.effects) if isinstance(e, SeriesCompliance)]
    if not springs:
        return
    if isinstance(damper.valve, AbstractInnerValve):
        if springs[1:]:
            raise CardError(
                "a second series_compliance cannot be exported: two springs are one",
                where=where,
                advice="Add their compliances up in the card",
            )
        return
    behind = [_kind(e) for e in damper.effects[springs[0] + 1 :] if e.stage == "motion"]
    behind += [_kind(e) for e in damper.effects if e.stage == "law"]
    for kind, why in BEHIND_NO_SPRING.items():
        if kind in behind:
            raise CardError(
                f"{kind} behind series_compliance cannot be exported: {why}",
                where=where,
                advice="Leave one of them out, or use `sysid simulate`",
            )
