"""Conflict diagrams: what each controller makes of acceleration and working space."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.isolator.base_motion import BaseMotion
from sysid.isolator.closed_loop import (
    CLOCK,
    SENSOR,
    Clock,
    Performance,
    Sampled,
    Sensor,
    performance,
    sampled,
)
from sysid.isolator.controllers.base import AbstractController
from sysid.isolator.damper_step import AbstractDamperStep
from sysid.isolator.families import Family
from sysid.isolator.plant import Number, Plant, mass_isolator

Runs = Float[np.ndarray, "set_points variants motions"]
M = TypeVar("M")


@dataclass(frozen=True)
class Curve:
    """One controller's part of a diagram; NaN where a run ran away.

    Attributes:
        name: Of the controller.
        set_points: D in N·s/m, or currents in A.
        unit: Of them.
        acceleration: RMS, m/s².
        working_space: RMS, m.
        piston_speed: Largest of each run, m/s.
        current: RMS, A.
        force: RMS, N.
        tyre: RMS deflection, m; zeros where there is no tyre.
        beyond: Share of time that the piston is faster than the damper was tested.
    """

    name: str
    set_points: tuple[float, ...]
    unit: str
    acceleration: Runs
    working_space: Runs
    piston_speed: Runs
    current: Runs
    force: Runs
    tyre: Runs
    beyond: Runs


@dataclass(frozen=True)
class ConflictDiagram:
    """All runs of a study: controllers × set points × variants of the damper × base motions.

    Attributes:
        variants: What the damper's variants are, one word each: temperatures, as a rule.
        motion: What the base does, in words.
        curves: One a controller.
    """

    variants: tuple[str, ...]
    motion: str
    curves: tuple[Curve, ...]

    @property
    def runs(self) -> int:
        """How many simulations it holds."""
        return sum(curve.acceleration.size for curve in self.curves)

    def curve(self, name: str) -> Curve:
        """The curve of a controller.

        Raises:
            KeyError: It is not in the diagram.
        """
        for one in self.curves:
            if one.name == name:
                return one
        raise KeyError(name)


def conflict_diagram(
    plant: Plant,
    families: Sequence[Family],
    dampers: AbstractDamperStep,
    variants: Sequence[str],
    base: BaseMotion,
    clock: Clock = CLOCK,
    sensor: Sensor = SENSOR,
    fastest: float = np.inf,
) -> ConflictDiagram:
    """Run every controller at every set point with every damper on every motion.

    Args:
        plant: The plant.
        families: Controllers.
        dampers: One module whose arrays have the variants in front (`stacked`).
        variants: Their names.
        base: Motions.
        clock: Time steps.
        sensor: Of the force, if it reads more than the valve.
        fastest: Speed up to which the damper was tested, m/s.

    Source:
        BS09 Figs. 9 to 12.
    """
    found = _all(
        plant, tuple(f.controllers for f in families), dampers, sampled(base, clock), clock,
        Sensor(*(jnp.asarray(float(z)) for z in sensor)), jnp.asarray(fastest),
    )  # fmt: skip
    curves = tuple(
        Curve(f.name, f.set_points, f.unit, *(_ended(z) for z in one))
        for f, one in zip(families, found, strict=True)
    )
    return ConflictDiagram(tuple(variants), base.name, curves)


def _ended(runs: Float[Array, "..."]) -> Runs:
    """NaN for runs that ran away."""
    found = np.asarray(runs)
    return np.where(np.isfinite(found), found, np.nan)


@eqx.filter_jit
def _all(
    plant: Plant,
    controllers: tuple[AbstractController, ...],
    dampers: AbstractDamperStep,
    base: Sampled,
    clock: Clock,
    sensor: Sensor,
    fastest: Number,
) -> tuple[Performance, ...]:
    def run(
        controller: AbstractController, damper: AbstractDamperStep, base: Sampled
    ) -> Performance:
        return performance(plant, damper, controller, base, clock, sensor=sensor, fastest=fastest)

    mapped = eqx.filter_vmap(run, in_axes=(None, None, 0))
    mapped = eqx.filter_vmap(mapped, in_axes=(None, eqx.if_array(0), None))
    mapped = eqx.filter_vmap(mapped, in_axes=(eqx.if_array(0), None, None))
    return tuple(mapped(controller, dampers, base) for controller in controllers)


def stacked(modules: Sequence[M]) -> M:
    """Modules of one kind as one whose arrays have them in front."""
    return jax.tree.map(lambda *z: jnp.stack(z), *modules)


def ideal_curve(
    dampings: Sequence[float], base: BaseMotion, clock: Clock = CLOCK, mass: float | None = None
) -> Curve:
    """The ideal, active skyhook on the mass isolator: F = −D ẋ_m with nothing else.

    Args:
        dampings: D, N·s/m.
        base: Motions.
        clock: Time steps.
        mass: kg, if another.

    Returns:
        A curve with one variant.
    """
    from sysid.isolator.controllers.passive import Passive
    from sysid.isolator.damper_step import NoDamper

    known = {} if mass is None else {"mass": mass}
    plants = stacked([mass_isolator(skyhook=d, **known) for d in dampings])
    one = jnp.ones(())

    @jax.jit
    def run(plants: Plant, base: Sampled) -> Performance:
        def each(plant: Plant, base: Sampled) -> Performance:
            return performance(plant, NoDamper(one), Passive(0.0 * one), base, clock)

        return jax.vmap(jax.vmap(each, in_axes=(None, 0)), in_axes=(0, None))(plants, base)

    found = run(plants, sampled(base, clock))
    runs = (np.asarray(z)[:, None, :] for z in found)
    return Curve("ideal", tuple(dampings), "N·s/m", *runs)
