"""What may change a damper's force from cycle to cycle: effects, and what only looks like one."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.diagnosis.cycle_evidence import CycleEvidence, Cycles
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.prototypes import NEED_CYCLES, magnitude, magnitudes
from sysid.effects.base import AbstractEffect
from sysid.effects.registry import effect_kind, make
from sysid.models.base import AbstractValve
from sysid.models.damper import Damper
from sysid.motion.history import into_cycle
from sysid.motion.motion import Motion
from sysid.parameters import specs

BY_CYCLES: Final = (0.5, 2.0, 5.0)
"""Cycles in which a decoy falls to 1/e."""
BY_TIME: Final = (1.0e-3, 5.0e-3, 5.0e-2)
"""1/s, rates of a decoy."""


@dataclass(frozen=True)
class Candidate:
    """A change of the force from cycle to cycle, with one shape parameter.

    Attributes:
        id: Of the effect; in words for a decoy.
        symbol: Of its shape parameter.
        shapes: Values of it that are tried, in order.
        nominal: Size to begin with.
        signed: The size may not be negative.
        effect: At nominal values; None for a decoy.
        change: (shape, size) → [T, C, m] N, centred.
    """

    id: str
    symbol: str
    shapes: tuple[float, ...]
    nominal: float
    signed: bool
    effect: AbstractEffect | None
    change: Callable[[float, float], Cycles]


def candidates(
    evidence: Evidence, cycles: CycleEvidence, valve: AbstractValve
) -> tuple[Candidate, ...]:
    """Every effect that needs the cycles, at the magnitudes of this damper."""
    return tuple(_candidate(id, evidence, cycles, valve) for id in NEED_CYCLES)


def _candidate(
    id: str, evidence: Evidence, cycles: CycleEvidence, valve: AbstractValve
) -> Candidate:
    kind = effect_kind(id)
    size = magnitudes(evidence.loops)
    symbol, spec = kind.facts.size, {s.symbol: s for s in specs(kind)}
    (shape,) = set(spec) - {symbol}
    ends = {*kind.facts.realistic[shape], kind.facts.nominal[shape]}
    into = jnp.asarray(_filled(evidence))
    plain = _forces(Damper(valve), evidence.motion, into, jnp.zeros(1), evidence.columns)
    numbers = jnp.arange(float(cycles.change.shape[1]))

    def change(at: float, amount: float) -> Cycles:
        damper = Damper(valve, (with_values(make(kind), {shape: at, symbol: amount}),))
        added = _forces(damper, evidence.motion, into, numbers, evidence.columns) - plain
        each = np.moveaxis(np.asarray(added), 0, 1)[cycles.tests]
        return cycles.centred(each)

    return Candidate(
        id=id,
        symbol=shape,
        shapes=tuple(sorted(ends)),
        nominal=kind.facts.nominal[symbol] * magnitude(spec[symbol].unit, size),
        signed=bool(np.isfinite(spec[symbol].low)),
        effect=make(kind),
        change=change,
    )


def with_values(effect: AbstractEffect, values: dict[str, float]) -> AbstractEffect:
    """The effect at other values, of the same types so that nothing is compiled anew."""
    symbols = list(values)
    new = [jnp.asarray(np.float64(values[s])) for s in symbols]
    return eqx.tree_at(lambda e: [getattr(e, s) for s in symbols], effect, new)


def decoys(
    evidence: Evidence, cycles: CycleEvidence, valve: AbstractValve
) -> tuple[Candidate, ...]:
    """What no effect is: the whole force, or its yield part, decays alike in all tests.

    A cell or an amplifier that warms up does that, and so does a coil whose current falls as it
    gets hot.
    """
    whole, parts = valve.force(evidence.motion), valve.parts(evidence.motion)
    force, yielding = (np.asarray(z)[cycles.tests] for z in (whole, parts.yielding))
    into = into_cycle(evidence.loops, force.shape[1])[cycles.tests]
    numbers = np.arange(cycles.change.shape[1])[None, :, None] + into[:, None, :]
    time = (numbers + 0.5) / evidence.loops.frequency[cycles.tests][:, None, None]
    columns = np.asarray(evidence.columns)

    def of(
        loop: np.ndarray, course: Callable[[float], np.ndarray]
    ) -> Callable[[float, float], Cycles]:
        def change(at: float, amount: float) -> Cycles:
            return cycles.centred((amount * course(at) * loop[:, None, :]) @ columns)

        return change

    def by_cycles(n: float) -> np.ndarray:
        return np.exp(-numbers / n)

    def by_time(h: float) -> np.ndarray:
        return np.exp(-h * time)

    return tuple(
        Candidate(f"{what} that goes with {how}", "", shapes, 0.01, False, None, of(loop, course))
        for what, loop in (("a gain", force), ("a yield force", yielding))
        for how, shapes, course in (
            ("the number of the cycle", BY_CYCLES, by_cycles),
            ("time", BY_TIME, by_time),
        )
    )


def _filled(evidence: Evidence) -> Float[np.ndarray, "loop point"]:
    """`into_cycle` of the loops as they are simulated, filled up with the last."""
    into = into_cycle(evidence.loops, evidence.motion.velocity.shape[1])
    missing = evidence.motion.velocity.shape[0] - len(into)
    return np.concatenate([into, np.repeat(into[-1:], missing, axis=0)])


@eqx.filter_jit
def _forces(
    damper: Damper, motion: Motion, into: Array, numbers: Float[Array, " cycle"], columns: Array
) -> Float[Array, "cycle loop m"]:
    """Harmonics of the force in each cycle of a test."""

    def one(number: Array) -> Array:
        return damper.force(replace(motion, cycle=number + into)) @ columns

    return jax.lax.map(one, numbers)


def followed(evidence: Evidence, cycles: CycleEvidence, valve: AbstractValve) -> CycleEvidence:
    """The evidence without what the model makes of the stroke that each cycle really had."""
    loops = evidence.loops
    turn = np.exp(-2j * np.pi * np.arange(loops.force.shape[1]) / loops.force.shape[1])
    scale = np.ones((cycles.change.shape[1], evidence.motion.frequency.shape[0], 1))
    for k, rows in zip(cycles.tests, cycles.rows, strict=True):
        path = loops.displacement[k] + loops.displacement_deviations[k][rows]
        stroke = np.abs(path @ turn)
        scale[: len(rows), k, 0] = stroke / stroke.mean()
    forces = _stretched(Damper(valve), evidence.motion, jnp.asarray(scale), evidence.columns)
    each = np.moveaxis(np.asarray(forces), 0, 1)[cycles.tests]
    return replace(cycles, change=cycles.change - cycles.centred(each))


@eqx.filter_jit
def _stretched(
    damper: Damper, motion: Motion, scale: Float[Array, "cycle loop 1"], columns: Array
) -> Float[Array, "cycle loop m"]:
    def one(factor: Array) -> Array:
        moved = replace(
            motion,
            displacement=factor * motion.displacement,
            velocity=factor * motion.velocity,
            acceleration=factor * motion.acceleration,
            peak_velocity=factor * motion.peak_velocity,
        )
        return damper.force(moved) @ columns

    return jax.lax.map(one, scale)
