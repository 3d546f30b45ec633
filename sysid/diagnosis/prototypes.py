"""Candidates of the screen, brought to the magnitudes of the damper that was tested.

Nominal values and realistic ranges of the catalogue are those of a damper of about 500 N and
25 mm.  A damper of another size has effects of another size: every parameter is scaled by its
unit, N by the force and m by the stroke; seconds, amperes and kelvins stay.  Where something
begins, what a force range holds and what power heats go by what the tests reached.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Final

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.data.loops import Loops
from sysid.effects.base import AbstractEffect
from sysid.effects.registry import EFFECTS, choices, make
from sysid.parameters import specs

FORCE: Final = 500.0
"""N, RMS force of the damper that the catalogue's values are for."""
STROKE: Final = 0.025
"""m, its amplitude."""

SIZES: Final[Mapping[str, tuple[float, ...]]] = {
    "backlash": (0.03, 0.1, 0.3, 1.0),
    "entrained_air": (0.03, 0.1, 0.3, 1.0),
    "series_compliance": (0.3, 1.0),
    "force_delay": (0.3, 1.0),
    "force_filter": (0.3, 1.0),
    "seating_leakage": (0.3, 1.0),
    "width_law": (0.2,),
    "force_clipping": (1.0, 1.01, 1.02, 1.04, 1.08),
}
"""Effects whose shape changes with their size: sizes to try, in parts of the nominal one.  A force
range ends about the largest force that was recorded; what it cuts off goes by its last percent."""
BEGINNING: Final = frozenset({"force_clipping"})
"""Those among them that are nothing at all below some size."""
SHRINKING: Final = frozenset(SIZES) - BEGINNING
"""Those that are the less, the smaller their size."""
NEED_CYCLES: Final = ("first_cycle_breakaway", "self_heating")
"""Effects that the mean over the cycles of a test does not show (`within_tests`)."""
STOPS: Final = (0.5, 0.7, 0.85)
"""Where an end stop may begin, in parts of the largest travel."""
HOT: Final = 5.0
"""K by which oil may be warmer than its thermometer says, in the test of most work."""
GUIDED: Final = (1.15, 1.5, 3.0)
"""Distance between the guides at the centre, in parts of the largest travel: more than one."""


@dataclass(frozen=True)
class Magnitudes:
    """What sets the size of effects in a campaign.

    Attributes:
        force: N, RMS over the campaign.
        stroke: m, median amplitude.
        peak: N, largest force.
        travel: m, largest distance from the centre of a test.
        power: W, largest product of RMS force and RMS speed of a test: that of its heat but for
            what springs and masses give back.
    """

    force: float
    stroke: float
    peak: float
    travel: float
    power: float


def magnitudes(loops: Loops) -> Magnitudes:
    """Magnitudes of measured loops."""
    return Magnitudes(
        force=float(np.sqrt(np.mean(loops.force**2))),
        stroke=float(np.median(loops.amplitude)),
        peak=float(np.abs(loops.force).max()),
        travel=float(np.abs(loops.displacement).max()),
        power=float(np.sqrt(_mean_square(loops.force) * _mean_square(loops.velocity)).max()),
    )


def _mean_square(z: Float[np.ndarray, "loop point"]) -> Float[np.ndarray, " loop"]:
    return np.mean(z**2, axis=1)


_TERM = re.compile(r"(kg|N|m|s|A|K|J|W)(?:²)?")


def exponents_of(unit: str) -> tuple[int, int]:
    """Exponents of newton and metre in a unit such as "N·s/m" or "m/(s·N)".

    A kilogram counts as N·s²/m, a joule and a watt as N·m and N·m/s.
    """
    newton = metre = 0
    above, _, below = unit.partition("/")
    for text, sign in ((above, 1), (below, -1)):
        for match in _TERM.finditer(text):
            power = sign * (2 if match.group().endswith("²") else 1)
            newton += power * (match.group(1) in ("N", "kg", "J", "W"))
            metre += power * ((match.group(1) in ("m", "J", "W")) - (match.group(1) == "kg"))
    return newton, metre


def magnitude(unit: str, size: Magnitudes) -> float:
    """Factor from the catalogue's damper to this one for a parameter of a unit."""
    newton, metre = exponents_of(unit)
    return (size.force / FORCE) ** newton * (size.stroke / STROKE) ** metre


def prototypes(
    size: Magnitudes, found_from: tuple[str, ...] = ("loops",)
) -> tuple[AbstractEffect, ...]:
    """Every effect that such tests can show, in each of its forms, at values for this damper.

    Args:
        size: Of the campaign.
        found_from: Kinds of evidence that the campaign has.
    """
    return tuple(
        _at(make(kind, choice=form), _nominal(kind, size))
        for kind in EFFECTS
        if kind.facts.found_from in found_from
        for form in choices(kind)
    )


def _nominal(kind: type[AbstractEffect], size: Magnitudes) -> dict[str, float]:
    values = {s.symbol: kind.facts.nominal[s.symbol] * magnitude(s.unit, size) for s in specs(kind)}
    if "x_b" in values:
        values["x_b"] = STOPS[1] * size.travel
    if "l_g" in values:
        values["l_g"] = GUIDED[1] * size.travel
    if "R_th" in values:
        values["R_th"] = HOT / size.power
    if "q_F" in values:
        values["q_F"] = 1.0 / size.peak
    return values


def shape_grid(effect: AbstractEffect, size: Magnitudes) -> list[AbstractEffect]:
    """The effect with each of its shape parameters at low, nominal and high realistic values.

    Shape parameters mean nothing while the size is zero, so the largest score over a grid is used
    and the number of shapes is counted in the threshold (Davies, Biometrika 64 (1977)).
    """
    facts = effect.facts
    grids: dict[str, list[float]] = {}
    for s in specs(effect):
        now = float(getattr(effect, s.symbol))
        if s.symbol == facts.size:
            grids[s.symbol] = [part * now for part in SIZES.get(facts.id, (1.0,))]
        elif s.symbol == "x_b":
            grids[s.symbol] = [part * size.travel for part in STOPS]
        elif s.symbol == "l_g":
            grids[s.symbol] = [part * size.travel for part in GUIDED]
        elif s.symbol in facts.realistic:
            ends = {*facts.realistic[s.symbol], facts.nominal[s.symbol]}
            grids[s.symbol] = [v * magnitude(s.unit, size) for v in sorted(ends)]
    return [
        _at(effect, dict(zip(grids, values, strict=True))) for values in product(*grids.values())
    ]


def size_of(effect: AbstractEffect) -> float:
    """Value of the parameter that is zero without the effect, in its unit."""
    return float(getattr(effect, effect.facts.size))


def at_size(effect: AbstractEffect, size: float) -> AbstractEffect:
    """The same effect, of its own shape, only more or less of it.

    Args:
        effect: Of any size but zero.
        size: In the unit of its size parameter; nothing else is changed where it is zero.
    """
    facts = effect.facts
    part = abs(size) / abs(size_of(effect)) or 1.0
    others = {s: part * float(getattr(effect, s)) for s in facts.with_size}
    return _at(effect, {facts.size: size} | others)


def _at(effect: AbstractEffect, values: Mapping[str, float]) -> AbstractEffect:
    """The effect at other values."""
    symbols = list(values)
    new: list[Float[Array, ""]] = [jnp.asarray(float(values[s])) for s in symbols]
    return eqx.tree_at(lambda e: [getattr(e, s) for s in symbols], effect, new)
