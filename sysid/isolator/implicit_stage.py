r"""One stage of the integrator, in which plant and damper are solved together.

The integrator is the two-stage, second-order, L-stable diagonally implicit Runge–Kutta method

    Y_1 = y_n + γ h f(Y_1),    Y_2 = y_n + (1 − γ) h f(Y_1) + γ h f(Y_2),    y_{n+1} = Y_2

with γ = 1 − 1/√2.  Both stages read Y = K + g f(Y) with g = γ h and a known K, where K_2 =
y_n + (Y_1 − y_n)(1 − γ)/γ.  A linear plant answers the damper's force linearly within a stage,
q = q_free + p F, so the damper meets v = v_free − α F, one number each, and solves for its own
state.

Source:
    R. Alexander, Diagonally implicit Runge–Kutta methods for stiff O.D.E.'s, SIAM J. Numer. Anal.
    14 (1977).
"""

from typing import Final, NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.isolator.plant import Number, Plant, Row, State, dot

GAMMA: Final = 1.0 - 0.5**0.5
STAGES: Final = (GAMMA, 1.0)
"""When the stages are, in parts of a step."""
CARRIED: Final = (1.0 - GAMMA) / GAMMA


def onward(begin: Number, first: Number) -> Number:
    """K_2 = y_n + (Y_1 − y_n)(1 − γ)/γ, of one number."""
    return begin + CARRIED * (first - begin)


class Base(NamedTuple):
    """Motion of the base at one time.

    Attributes:
        displacement: m.
        velocity: m/s.
    """

    displacement: Number
    velocity: Number


class StagedPlant(NamedTuple):
    """A plant as a stage of length g sees it.

    Attributes:
        plant: The plant.
        length: g, s.
        resolvent: (1 − g A)⁻¹, [n, n].
        push: Change of the state per newton of the damper, [n].
        mobility: α, m/s per newton.
        shift: Change of the piston's displacement per newton, m/N.
    """

    plant: Plant
    length: Number
    resolvent: Float[Array, "n n"]
    push: Row
    mobility: Number
    shift: Number

    def free(self, known: State, base: Base) -> State:
        """State at the end of the stage if the damper did nothing."""
        plant, g = self.plant, self.length
        driven = [
            known[k] + g * (plant.base[k] * base.displacement + plant.rate[k] * base.velocity)
            for k in range(plant.size)
        ]
        return tuple(dot(self.resolvent[k], driven) for k in range(plant.size))

    def pushed(self, free: State, force: Number) -> State:
        """State with the damper's force."""
        return tuple(free[k] + self.push[k] * force for k in range(self.plant.size))


class Port(NamedTuple):
    """Where plant and damper meet within a stage: v = v_free − α F, x = x_free + s F.

    Attributes:
        velocity: v_free, m/s.
        mobility: α, m/s per newton.
        displacement: x_free, m.
        shift: s, m per newton.
        length: g, s.
    """

    velocity: Number
    mobility: Number
    displacement: Number
    shift: Number
    length: Number


def staged(plant: Plant, step: float) -> StagedPlant:
    """A plant for steps of a length, s."""
    g = jnp.asarray(GAMMA * step)
    resolvent = jnp.linalg.inv(jnp.eye(plant.size) - g * plant.matrix)
    push = g * resolvent @ plant.force
    return StagedPlant(
        plant, g, resolvent, push,
        -(plant.piston_velocity.row @ push), plant.piston_displacement.row @ push,
    )  # fmt: skip


def port(plant: StagedPlant, free: State, base: Base) -> Port:
    """What a damper meets."""
    x, v = plant.plant.piston_displacement, plant.plant.piston_velocity
    none = jnp.zeros(())
    return Port(
        v.of(free, base.displacement, base.velocity, none),
        plant.mobility,
        x.of(free, base.displacement, base.velocity, none),
        plant.shift,
        plant.length,
    )
