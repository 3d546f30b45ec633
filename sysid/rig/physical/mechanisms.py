"""Every mechanism by name and its switch: 0 takes it out, 1 is the damper as built."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import equinox as eqx

from sysid.errors import DataError
from sysid.rig.physical.damper import PhysicalDamper

ENDLESS: Final = 1e14
"""N/m and m³ that stand for a spring that does not bend and a gas that no stroke squeezes."""


@dataclass(frozen=True)
class Mechanism:
    """One thing that the damper or its rig does and a base model does not.

    Attributes:
        name: Of the switch.
        causes: Ids of the public catalogue under which it may be named.
        about: In words.
        changed: The damper with the mechanism at a level.
    """

    name: str
    causes: tuple[str, ...]
    about: str
    changed: Callable[[PhysicalDamper, float], PhysicalDamper]


def times(*constants: str) -> Callable[[PhysicalDamper, float], PhysicalDamper]:
    """A mechanism whose size is that of some constants, each named part.constant."""

    def changed(damper: PhysicalDamper, level: float) -> PhysicalDamper:
        for constant in constants:
            damper = _with(damper, constant, level * _get(damper, constant))
        return damper

    return changed


def divided(constant: str) -> Callable[[PhysicalDamper, float], PhysicalDamper]:
    """A mechanism that grows as a constant falls, such as a spring's softness."""

    def changed(damper: PhysicalDamper, level: float) -> PhysicalDamper:
        value = _get(damper, constant) / level if level > 0.0 else ENDLESS
        return _with(damper, constant, value)

    return changed


def _stribeck(damper: PhysicalDamper, level: float) -> PhysicalDamper:
    seal = damper.seal
    return _with(damper, "seal.breakaway", seal.sliding + level * (seal.breakaway - seal.sliding))


def _thinning(damper: PhysicalDamper, level: float) -> PhysicalDamper:
    """Another exponent through the same viscosity at 1000 1/s."""
    oil = damper.oil
    exponent = 1.0 - level * (1.0 - oil.exponent)
    damper = _with(damper, "oil.consistency", oil.consistency * 1000.0 ** (oil.exponent - exponent))
    return _with(damper, "oil.exponent", exponent)


MECHANISMS: Final = (
    Mechanism("entrained_air", ("entrained_air", "series_compliance"),
              "free air in the oil", times("oil.air")),
    Mechanism("gas_mixing", ("entrained_air",),
              "gas that comes out of solution in the rod's chamber",
              times("mixing.release", "mixing.most")),
    Mechanism("gas_spring", ("gas_spring", "gas_polytropic"),
              "the rod squeezes the accumulator's gas", divided("gas.volume")),
    Mechanism("seal_friction", ("seal_friction", "presliding_friction"),
              "friction of the rod's seal", times("seal.sliding", "seal.breakaway")),
    Mechanism("stribeck", ("stribeck_friction",),
              "more friction at rest than in motion", _stribeck),
    Mechanism("pressed_seal", ("asymmetric_gain", "seal_friction"),
              "the seal rubs more under pressure", times("seal.per_pressure")),
    Mechanism("floating_friction", ("presliding_friction", "backlash"),
              "friction of the floating piston", times("floating.sliding", "floating.breakaway")),
    Mechanism("entrance_loss", ("quadratic_loss",),
              "loss with the square of speed at the valve's ends", times("valve.entrance")),
    Mechanism("shear_thinning", ("shear_thinning",), "the fluid thins in shear", _thinning),
    Mechanism("leakage", ("bypass_leakage", "seating_leakage"),
              "flow before the fluid yields", times("valve.creep")),
    Mechanism("mount_compliance", ("series_compliance",),
              "mounts and load cell bend", divided("rig.mount")),
    Mechanism("play", ("backlash",), "play in the mounts", times("rig.play")),
    Mechanism("column_compliance", ("waveform_distortion",),
              "force pushes the actuator back", divided("rig.column")),
    Mechanism("thermal_viscosity", ("viscosity_temperature",),
              "viscosity falls with temperature", times("oil.activation")),
    Mechanism("thermal_yield", ("yield_temperature",),
              "yield stress falls with temperature", times("oil.yield_loss")),
    Mechanism("expansion", ("gas_temperature", "stiffness_temperature"),
              "warm oil squeezes the gas", times("oil.expansion")),
    Mechanism("magnetic_memory", ("magnetic_hysteresis", "residual_magnetism"),
              "the iron keeps a field", times("magnet.coercive")),
    Mechanism("coil_lag", ("coil_lag",),
              "current behind its command; nothing at constant current",
              times("magnet.inductance")),
    Mechanism("wear", ("run_drift",), "loss with sliding distance",
              times("wear.seal", "wear.gas", "wear.creep")),
)  # fmt: skip
IDLE: Final = frozenset({"coil_lag"})
"""Mechanisms that do nothing at constant current, and so in none of these tests."""
NOT_SHOWN: Final = frozenset({"magnetic_hysteresis"})
"""Causes that no campaign shows: the current is off between tests, so that their order in current
changes nothing."""
ALWAYS: Final = {
    "force_offset": "static force of the gas on the rod: nobody took a tare",
    "gas_temperature": "the same force grows with the temperature of gas and oil",
    "fluid_inertia": "oil in the valve's gap, moved by the piston",
    "linear_viscosity": "the fluid's viscosity, and the lubricating films of both seals",
    "force_filter": "conditioner of the load cell, 250 Hz, of the displacement 500 Hz",
    "force_delay": "delay of the two conditioners against each other, 0.45 ms",
    "force_quantization": "steps of the converter, 0.3 N",
    "self_heating": "the oil is warmed by the test itself",
    "surface_temperature": "the thermocouple is on the body, the oil is warmer",
}
"""Id of the catalogue → what of the damper or its rig it is, for which there is no switch."""


def causes_at_work(levels: Mapping[str, float]) -> frozenset[str]:
    """Ids of the catalogue that are true of a damper in its rig.

    Args:
        levels: Mechanism → level; 1 where none is given.
    """
    working = (m for m in MECHANISMS if m.name not in IDLE and levels.get(m.name, 1.0) > 0.0)
    return frozenset(ALWAYS).union(*(m.causes for m in working)) - NOT_SHOWN


def at_levels(damper: PhysicalDamper, levels: Mapping[str, float]) -> PhysicalDamper:
    """The damper with mechanisms at other levels than 1.

    Args:
        damper: As built.
        levels: Mechanism → level, 0 or more.

    Raises:
        DataError: There is no such mechanism, or a level is negative.
    """
    known = {mechanism.name: mechanism for mechanism in MECHANISMS}
    for name, level in levels.items():
        if name not in known:
            raise DataError(
                f"the physical damper has no mechanism {name!r}",
                advice=f"Mechanisms: {', '.join(known)}",
            )
        if not level >= 0.0:
            raise DataError(f"level {level:g} of {name} is negative", advice="Give 0 or more")
        damper = known[name].changed(damper, level)
    return damper


def _get(damper: PhysicalDamper, constant: str) -> float:
    part, name = constant.split(".")
    return getattr(getattr(damper, part), name)


def _with(damper: PhysicalDamper, constant: str, value: float) -> PhysicalDamper:
    part, name = constant.split(".")
    return eqx.tree_at(lambda d: getattr(getattr(d, part), name), damper, value)
