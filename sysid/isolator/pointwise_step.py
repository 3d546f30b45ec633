"""A damper in a closed loop whose force is found at an instant: from motion, current and memory."""

from collections.abc import Callable
from functools import reduce
from operator import add
from typing import Any, Final, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.effects.base import AbstractDriveEffect, AbstractForceEffect
from sysid.isolator.damper_step import AbstractDamperStep
from sysid.isolator.fractional_power import FractionalPower
from sysid.isolator.implicit_stage import Port, onward
from sysid.isolator.memory import AbstractMemory, Moved, instant
from sysid.isolator.plant import Number
from sysid.isolator.root import STEEPEST, falling_root, with_slope
from sysid.models.damper import Damper
from sysid.motion.motion import Motion

NEWTON: Final = 6
"""Newton's steps for the force of a stage; its equation is nearly straight, for a step is short."""
_SMALL_FORCE: Final = 1.0
"""N; less need not be known to more than 10⁻⁹ of it."""


class PistonState(NamedTuple):
    """What the force of a stage is found from.

    Attributes:
        speed: Of the piston, m/s; what it gains in a stage is the acceleration.
        side: Sign of the acceleration, 1 or −1; 0 at rest.
        force: N.
        travelled: By the piston since the run began, the integral of its speed, m.
        begun: The same where the step began, from where memories count their travel, m.
        remembered: States of the memories.
        cells: Of the filter that a law of frequency stands as; empty without one.
    """

    speed: Number
    side: Number
    force: Number
    travelled: Number
    begun: Number
    remembered: tuple[Any, ...]
    cells: tuple[Number, ...] = ()


class PointwiseStep(AbstractDamperStep):
    r"""A damper whose force is a function of what happens at an instant and of what it remembers.

        F = Φ(x, v, a, sgn a, v_m, i, w),    v_m = √max(v² − a x, 0)

    The acceleration follows from the force and the force, through its sign and the peak speed (W11
    Eq. 10), from the acceleration.  With either sign the equation is solved by Newton's method.
    Where both solutions agree with their sign the last one stays, as on a loop; where the force is
    too small for the one sign and too large for the other, the piston keeps its speed.  A valve
    that has a state does not feel the sign.  States w are those at the end of the stage, after the
    travel and the velocity that the force itself leaves.  Travel is the integral of velocity by
    the same stages: where a stiff state holds the piston, it then holds its velocity at zero, and
    the force is right, which it would not be if travel were read off a base that is known exactly.

    A law of frequency acts on the valve's force, not on friction and the like beside it.

    Attributes:
        damper: Its valve, and effects without memory.
        tau: s.
        temperature: °C; NaN where the card has none.
        currents: A, at which gain scheduling reads its table, rising.
        drives: Effects between the current and what the valve feels of it.
        memories: What the valve and friction beside it remember.
        sided: The valve feels the sign of the acceleration.
        power: Law of frequency of the valve's force, as a filter; None without one.

    Source:
        W11 Eqs. 3–10; Eq. 10 at every instant, radicand clipped at 0.
    """

    damper: Damper
    tau: Number
    temperature: Number
    currents: tuple[float, ...] = eqx.field(static=True)
    drives: tuple[AbstractDriveEffect, ...] = ()
    memories: tuple[AbstractMemory, ...] = ()
    sided: bool = eqx.field(static=True, default=True)
    power: FractionalPower | None = None

    def start(self) -> PistonState:
        """At rest."""
        none = jnp.zeros_like(self.temperature)
        remembered = tuple(m.start() for m in self.memories)
        cells = () if self.power is None else self.power.start()
        return PistonState(none, none, none, none, none, remembered, cells)

    def carried(self, begin: PistonState, first: PistonState) -> PistonState:
        """What is integrated goes on; travel counts from where the step began."""
        kept = tuple(
            m.carried(y, z)
            for m, y, z in zip(self.memories, begin.remembered, first.remembered, strict=True)
        )
        return PistonState(
            onward(begin.speed, first.speed),
            onward(begin.side, first.side),
            onward(begin.force, first.force),
            onward(begin.travelled, first.travelled),
            begin.begun,
            kept,
            tuple(onward(y, z) for y, z in zip(begin.cells, first.cells, strict=True)),
        )

    def stage(self, known: PistonState, meets: Port, current: Number) -> tuple[PistonState, Number]:
        """The piston's next speed, and the force."""
        filtered = None if self.power is None else self.power.met(known.cells, meets.length)

        def moved(force: Number) -> tuple[Number, Number, Number]:
            v = meets.velocity - meets.mobility * force
            x = meets.displacement + meets.shift * force
            return x, v, (v - known.speed) / meets.length

        def forces(force: Number, side: Number) -> tuple[Number, Number, tuple[Any, ...]]:
            """Of the valve and beside it, where the piston ends under a force."""
            x, v, a = moved(force)
            end = self._felt(instant(x, v, a, side, current, self.temperature))
            at = Moved(known.travelled - known.begun + meets.length * v, meets.length, end)
            remembered = tuple(
                m.reached(z, at) for m, z in zip(self.memories, known.remembered, strict=True)
            )
            return *self._forces(end, remembered), remembered

        def solved(side: Number) -> tuple[Number, Number]:
            def lacking(force: Number) -> Number:
                valve, beside, _ = forces(force, side)
                if filtered is not None:
                    valve = filtered.direct * valve + filtered.past
                return valve + beside - force

            if not self.sided:
                force = falling_root(with_slope(lacking), known.force, _SMALL_FORCE)
            else:
                force = _newton(lacking, known.force)
            return force, moved(force)[2]

        if self.sided:
            force, side = _of_both(solved, known, meets)
        else:
            force, a = solved(jnp.zeros_like(current))
            side = jnp.sign(a)
        v = moved(force)[1]
        place = known.travelled + meets.length * v
        valve, _, remembered = forces(force, side)
        cells = () if filtered is None else filtered.after(valve)
        return PistonState(v, side, force, place, place, remembered, cells), force

    def force(self, at: Motion, remembered: tuple[Any, ...] = ()) -> Number:
        """Φ at 1 Hz, N.

        Args:
            at: One point (`instant`), [1], with the current before the `drives`.
            remembered: A state for every memory.
        """
        valve, beside = self._forces(self._felt(at), remembered)
        return valve + beside

    def at_speed(self, speed: float, currents: Float[Array, " n"]) -> Float[Array, " n"]:
        """Force at a steady speed that has lasted, without acceleration, N at each current."""
        v, none = jnp.asarray(speed), jnp.zeros(())

        def steady(current: Number) -> Number:
            at = instant(none, v, none, none, current, self.temperature)
            felt = self._felt(at)
            return self.force(at, tuple(m.sliding(felt) for m in self.memories))

        return jax.vmap(steady)(currents)

    def _felt(self, motion: Motion) -> Motion:
        """With the current that the valve feels."""
        for drive in self.drives:
            motion = eqx.tree_at(lambda m: m.current, motion, drive.current(motion))
        return motion

    def _forces(self, motion: Motion, remembered: tuple[Any, ...]) -> tuple[Number, Number]:
        """Of the valve with its laws, and of gas and all else that stands beside it, N."""
        damper = self.damper
        for memory, state in zip(self.memories, remembered, strict=True):
            damper = memory.into(damper, state)
        beside = [e for e in damper.effects if isinstance(e, AbstractForceEffect)]
        laws = tuple(e for e in damper.effects if not isinstance(e, AbstractForceEffect))
        valve = Damper(damper.valve, laws).force(motion)[0]
        forces = [e.force(motion)[0] for e in beside]
        gas = damper.valve.gas_force(motion)
        if gas is not None:
            valve, forces = valve - gas[0], [*forces, gas[0]]
        return valve, reduce(add, forces, jnp.zeros_like(valve))


def _newton(lacking: Callable[[Number], Number], force: Number) -> Number:
    """Some steps of Newton's method: through its peak speed W11's model may have no root."""

    def better(_: jax.Array, force: Number) -> Number:
        value, slope = jax.jvp(lacking, (force,), (jnp.ones_like(force),))
        return force - value / jnp.minimum(slope, STEEPEST)

    return jax.lax.fori_loop(0, NEWTON, better, force)


def _of_both(
    solved: Callable[[Number], tuple[Number, Number]], known: PistonState, meets: Port
) -> tuple[Number, Number]:
    """Force and side, of the solutions with either sign of the acceleration."""
    sides = jnp.array([1.0, -1.0])
    forces, accelerations = jax.vmap(solved)(sides)
    agrees = accelerations * sides > 0.0
    last = jnp.where(known.side < 0.0, 1, 0)
    kept = jnp.where(agrees[last], last, 1 - last)
    sliding = (meets.velocity - known.speed) / meets.mobility
    force = jnp.where(jnp.any(agrees), forces[kept], sliding)
    return force, jnp.where(jnp.any(agrees), sides[kept], 0.0)
