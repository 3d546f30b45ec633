"""Models without a state of their own inside a closed loop: W11's and its kin."""

from typing import Final, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.isolator.damper_step import AbstractDamperStep
from sysid.isolator.implicit_stage import Port
from sysid.isolator.plant import Number
from sysid.models.damper import Damper
from sysid.motion.motion import Motion

NEWTON: Final = 6
"""Newton's steps for the force of a stage; its equation is nearly straight, for a step is short."""
_STEEPEST: Final = -0.25
"""Largest slope that the equation is believed to have: it falls with the force."""


class PistonState(NamedTuple):
    """What the force of a stage is found from.

    Attributes:
        speed: Of the piston, m/s; what it gains in a stage is the acceleration.
        side: Sign of the acceleration, 1 or −1; 0 at rest.
        force: N.
    """

    speed: Number
    side: Number
    force: Number


class PointwiseStep(AbstractDamperStep):
    r"""A damper whose force is a function of what happens at an instant.

        F = Φ(x, v, a, sgn a, v_m, i),    v_m = √max(v² − a x, 0)

    The acceleration follows from the force and the force, through its sign and the peak speed (W11
    Eq. 10), from the acceleration.  With either sign the equation is solved by Newton's method.
    Where both solutions agree with their sign the last one stays, as on a loop; where the force is
    too small for the one sign and too large for the other, the piston keeps its speed.

    Attributes:
        damper: Without anything that remembers.
        tau: s.
        temperature: °C; NaN where the card has none.
        largest_current: A.

    Source:
        W11 Eqs. 3–10; Eq. 10 at every instant, radicand clipped at 0.
    """

    damper: Damper
    tau: Number
    temperature: Number
    largest_current: float = eqx.field(static=True)

    def start(self) -> PistonState:
        """At rest."""
        none = jnp.zeros_like(self.temperature)
        return PistonState(none, none, none)

    def stage(self, known: PistonState, meets: Port, current: Number) -> tuple[PistonState, Number]:
        """The piston's next speed, and the force."""

        def moved(force: Number) -> tuple[Number, Number, Number]:
            v = meets.velocity - meets.mobility * force
            x = meets.displacement + meets.shift * force
            return x, v, (v - known.speed) / meets.length

        def solved(side: Number) -> tuple[Number, Number]:
            def lacking(force: Number) -> Number:
                return self.force(*moved(force), side, current) - force

            def newton(_: jax.Array, force: Number) -> Number:
                value, slope = jax.jvp(lacking, (force,), (jnp.ones_like(force),))
                return force - value / jnp.minimum(slope, _STEEPEST)

            force = jax.lax.fori_loop(0, NEWTON, newton, known.force)
            return force, moved(force)[2]

        sides = jnp.array([1.0, -1.0])
        forces, accelerations = jax.vmap(solved)(sides)
        agrees = accelerations * sides > 0.0
        last = jnp.where(known.side < 0.0, 1, 0)
        kept = jnp.where(agrees[last], last, 1 - last)
        sliding = (meets.velocity - known.speed) / meets.mobility
        force = jnp.where(jnp.any(agrees), forces[kept], sliding)
        side = jnp.where(jnp.any(agrees), sides[kept], 0.0)
        return PistonState(moved(force)[1], side, force), force

    def force(self, x: Number, v: Number, a: Number, side: Number, current: Number) -> Number:
        """Φ, N.

        Args:
            x: m.
            v: m/s.
            a: m/s².
            side: Sign of the acceleration that the damper feels.
            current: A.
        """
        square = v * v - a * x
        moving = square > 0.0
        peak = jnp.where(moving, jnp.sqrt(jnp.where(moving, square, 1.0)), 0.0)
        one = [jnp.reshape(z, (1,)) for z in (x, v, a, side, peak, current, self.temperature)]
        still = jnp.zeros(1)
        motion = Motion(*one, time=still, frequency=still + jnp.nan, periodic=False)
        return self.damper.force(motion)[0]

    def at_speed(self, speed: float, currents: Float[Array, " n"]) -> Float[Array, " n"]:
        """Force at a steady speed, without acceleration, N at each current."""
        v, none = jnp.asarray(speed), jnp.zeros(())
        return jax.vmap(lambda i: self.force(none, v, none, none, i))(currents)
