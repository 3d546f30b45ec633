"""A plant, a damper and a sampled controller, run over a motion of the base."""

from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.isolator.base_motion import BaseMotion
from sysid.isolator.controllers.base import AbstractController
from sysid.isolator.damper_step import AbstractDamperStep
from sysid.isolator.implicit_stage import STAGES, Base, StagedPlant, onward, port, staged
from sysid.isolator.plant import Number, Plant, State
from sysid.isolator.skyhook import Sensed


@dataclass(frozen=True)
class Clock:
    """Time steps.

    Attributes:
        period: Between samples of the controller, s; its current is held meanwhile.
        steps: Of the integrator in a period.
    """

    period: float = 1e-3
    steps: int = 8

    @property
    def step(self) -> float:
        """Of the integrator, s."""
        return self.period / self.steps


CLOCK: Final = Clock()


class Sensor(NamedTuple):
    """What the controllers' force sensor reads beside the valve's force: of a gas.

    Attributes:
        bias: N.
        stiffness: N per metre of compression.
    """

    bias: Number | float = 0.0
    stiffness: Number | float = 0.0


SENSOR: Final = Sensor()


class Sampled(NamedTuple):
    """A motion of the base as the integrator needs it.

    Attributes:
        within: Displacement and velocity at every stage, [..., samples, steps, stages] m and m/s.
        at: The same at the samples themselves, [..., samples].
    """

    within: Base
    at: Base


class Performance(NamedTuple):
    """What a run is judged by.

    Attributes:
        acceleration: RMS of the isolated mass, m/s².
        working_space: RMS of the suspension, m.
        piston_speed: Largest, m/s.
        current: RMS of what the fluid feels, A.
        force: RMS of the damper, N.
        tyre: RMS deflection, m; 0 where there is none.
        beyond: Share of time that the piston is faster than the damper was tested.
    """

    acceleration: Number
    working_space: Number
    piston_speed: Number
    current: Number
    force: Number
    tyre: Number
    beyond: Number


class Trace(NamedTuple):
    """A run in time, at the samples of the controller.

    Attributes:
        state: Of the plant, [samples] each.
        damper: State of the damper, [samples] each.
        force: N.
        current: What the fluid feels, A.
        command: A.
        acceleration: m/s².
        working_space: m.
        piston_velocity: m/s.
    """

    state: tuple[Float[Array, " samples"], ...]
    damper: Any
    force: Float[Array, " samples"]
    current: Float[Array, " samples"]
    command: Float[Array, " samples"]
    acceleration: Float[Array, " samples"]
    working_space: Float[Array, " samples"]
    piston_velocity: Float[Array, " samples"]


class _Moving(NamedTuple):
    """What the integrator moves."""

    state: State
    damper: Any
    force: Number
    current: Number


class _Now(NamedTuple):
    """Everything that moves."""

    state: State
    damper: Any
    force: Number
    current: Number
    memory: Any
    sums: Performance


def sampled(base: BaseMotion, clock: Clock = CLOCK) -> Sampled:
    """Motions of a base at the times of an integrator, [motions, samples, ...]."""
    samples = round(base.duration / clock.period)
    begin = clock.period * np.arange(samples)
    inside = clock.step * (np.arange(clock.steps)[:, None] + np.array(STAGES))
    x, v = base.at(begin[:, None, None] + inside)
    x_0, v_0 = base.at(begin)
    return Sampled(Base(jnp.asarray(x), jnp.asarray(v)), Base(jnp.asarray(x_0), jnp.asarray(v_0)))


def performance(
    plant: Plant,
    damper: AbstractDamperStep,
    controller: AbstractController,
    base: Sampled,
    clock: Clock = CLOCK,
    *,
    sensor: Sensor = SENSOR,
    fastest: Number | float = np.inf,
) -> Performance:
    """How well one run isolates; pure, so it may be mapped over anything and compiled.

    Args:
        plant: The plant.
        damper: The damper at its temperature.
        controller: Of its current.
        base: One motion, [samples, ...].
        clock: Time steps.
        sensor: Of the force.
        fastest: Speed up to which the damper was tested, m/s.
    """
    advance = _period(plant, damper, controller, clock, sensor, fastest)
    sums = Performance(*[jnp.zeros(())] * len(Performance._fields))

    def step(now: _Now, base: Sampled) -> tuple[_Now, None]:
        return advance(now, base)[0], None

    end = jax.lax.scan(step, _begin(plant, damper, controller, sums), base)[0].sums
    count = base.at.velocity.shape[0]
    mean = jax.tree.map(lambda z: jnp.sqrt(z / count), end)
    return mean._replace(piston_speed=end.piston_speed, beyond=end.beyond / count)


def trace(
    plant: Plant,
    damper: AbstractDamperStep,
    controller: AbstractController,
    base: Sampled,
    clock: Clock = CLOCK,
    *,
    sensor: Sensor = SENSOR,
) -> Trace:
    """One run in time; arguments as `performance`."""
    advance = _period(plant, damper, controller, clock, sensor, np.inf)
    sums = Performance(*[jnp.zeros(())] * len(Performance._fields))
    return jax.lax.scan(advance, _begin(plant, damper, controller, sums), base)[1]


def _begin(
    plant: Plant, damper: AbstractDamperStep, controller: AbstractController, sums: Performance
) -> _Now:
    none = jnp.zeros(())
    return _Now((none,) * plant.size, damper.start(), none, none, controller.start(), sums)


def _period(
    plant: Plant,
    damper: AbstractDamperStep,
    controller: AbstractController,
    clock: Clock,
    sensor: Sensor,
    fastest: Number | float,
) -> Any:
    """One sample of the controller, and the steps until the next."""
    ready = staged(plant, clock.step)
    decays = [jnp.exp(-share * clock.step / damper.tau) for share in STAGES]

    def advance(now: _Now, base: Sampled) -> tuple[_Now, Trace]:
        at = (now.state, base.at.displacement, base.at.velocity, now.force)
        compression = plant.piston_displacement.of(*at)
        speed = plant.piston_velocity.of(*at)
        sensed = Sensed(
            plant.body_velocity.of(*at),
            plant.relative_velocity.of(*at),
            now.force + sensor.bias + sensor.stiffness * compression,
        )
        memory, wanted = controller.command(now.memory, sensed, jnp.asarray(clock.period))
        command = jnp.clip(wanted, 0.0, damper.largest_current)
        acceleration, space = plant.acceleration.of(*at), plant.working_space.of(*at)
        sums = Performance(
            now.sums.acceleration + acceleration**2,
            now.sums.working_space + space**2,
            jnp.maximum(now.sums.piston_speed, jnp.abs(speed)),
            now.sums.current + now.current**2,
            now.sums.force + now.force**2,
            now.sums.tyre + plant.tyre.of(*at) ** 2,
            now.sums.beyond + ~(jnp.abs(speed) <= fastest),  # a run that ran away counts
        )
        seen = Trace(
            now.state, now.damper, now.force, now.current, command, acceleration, space, speed
        )

        def step(begin: _Moving, base: Base) -> tuple[_Moving, None]:
            return _step(ready, damper, begin, command, decays, base), None

        moving = _Moving(now.state, now.damper, now.force, now.current)
        moving = jax.lax.scan(step, moving, base.within)[0]
        return _Now(*moving, memory, sums), seen

    return advance


def _step(
    plant: StagedPlant,
    damper: AbstractDamperStep,
    begin: _Moving,
    command: Number,
    decays: list[Number],
    base: Base,
) -> _Moving:
    """One step of the integrator: two stages; the lag of the current is solved exactly."""
    known, held, force, felt = begin
    for k, decay in enumerate(decays):
        at = Base(base.displacement[k], base.velocity[k])
        felt = command + (begin.current - command) * decay
        free = plant.free(known, at)
        held, force = damper.stage(held, port(plant, free, at), felt)
        known = plant.pushed(free, force)
        if k == 0:
            known = jax.tree.map(onward, begin.state, known)
            held = damper.carried(begin.damper, held)
    return _Moving(known, held, force, felt)
