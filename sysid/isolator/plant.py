"""Linear plants around one damper, and the mass on a spring of Batterbee and Sims."""

from collections.abc import Sequence
from typing import Final, NamedTuple, TypeAlias

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

Number: TypeAlias = Float[Array, "..."]
Row: TypeAlias = Float[Array, " n"]
State: TypeAlias = tuple[Number, ...]
"""Of a plant: not one array, since stacking keeps compilers from fusing a step into one loop."""

MASS: Final = 103.3
"""kg: C_post(0 A, 15 °C) = 1298 N·s/m of the paper's Table 1 is then a damping ratio of 0.2."""
NATURAL_FREQUENCY: Final = 5.0
"""Hz, of the paper."""


class Output(NamedTuple):
    """A quantity that follows from a plant's state, z = row·q + base y_b + rate ẏ_b + force F.

    Attributes:
        row: [n].
        base: Of the base's displacement.
        rate: Of the base's velocity.
        force: Of the damper's force.
    """

    row: Row
    base: Number
    rate: Number
    force: Number

    def of(self, state: State, base: Number, rate: Number, force: Number) -> Number:
        """Its value."""
        return dot(self.row, state) + self.base * base + self.rate * rate + self.force * force


class Plant(NamedTuple):
    """q̇ = A q + b y_b + c ẏ_b + d F, what the damper feels, and what is judged.

    Attributes:
        matrix: A, [n, n].
        base: b, [n].
        rate: c, [n].
        force: d, [n].
        piston_displacement: Compression of the damper, m; its velocity must not need F.
        piston_velocity: m/s.
        body_velocity: Absolute velocity of the isolated mass, m/s.
        relative_velocity: Compression rate of the suspension as the controller knows it, m/s.
        working_space: Compression of the suspension, m.
        acceleration: Of the isolated mass, m/s².
        tyre: What else is judged: deflection of the tyre, m, or zero.
    """

    matrix: Float[Array, "n n"]
    base: Row
    rate: Row
    force: Row
    piston_displacement: Output
    piston_velocity: Output
    body_velocity: Output
    relative_velocity: Output
    working_space: Output
    acceleration: Output
    tyre: Output

    @property
    def size(self) -> int:
        """Number of states."""
        return self.matrix.shape[-1]


def dot(row: Row, state: Sequence[Number]) -> Number:
    """Row times state, written out: states are few, and vectors of runs are long."""
    return sum((row[k] * state[k] for k in range(1, len(state))), row[0] * state[0])


def output(
    row: np.ndarray | list[float], base: float = 0.0, rate: float = 0.0, force: float = 0.0
) -> Output:
    """An output from numbers.

    Args:
        row: [n] weights of the states.
        base: Weight of the base's displacement.
        rate: Weight of the base's velocity.
        force: Weight of the damper's force; dimensionless, as all of them, for an output in SI.
    """
    return Output(
        jnp.asarray(row, dtype=float), *(jnp.asarray(float(z)) for z in (base, rate, force))
    )


def mass_isolator(
    mass: float = MASS,
    stiffness: float | None = None,
    *,
    skyhook: float = 0.0,
    gas_stiffness: float = 0.0,
    viscosity: float = 0.0,
) -> Plant:
    r"""A mass on a spring and a damper over a moving base.

        M ẍ_m = k_s (x_b − x_m) + F − D ẋ_m,    x = x_b − x_m

    Args:
        mass: M, kg.
        stiffness: k_s, N/m; that of 5 Hz where none is given.
        skyhook: D of an ideal, active skyhook beside the damper, N·s/m.
        gas_stiffness: Of the damper's gas, N/m, in parallel to the spring.
        viscosity: Of a linear dashpot beside the damper, N·s/m.

    Returns:
        States x_m and ẋ_m.

    Source:
        BS09 Fig. 8 and Section 4; mass and spring are not given there, but 5 Hz and a damping
        ratio of about 0.2.
    """
    k = mass * (2.0 * np.pi * NATURAL_FREQUENCY) ** 2 if stiffness is None else stiffness
    k = k + gas_stiffness
    to_body = np.array([-k, -(skyhook + viscosity)]) / mass
    return Plant(
        matrix=jnp.asarray(np.array([[0.0, 1.0], to_body])),
        base=jnp.asarray([0.0, k / mass]),
        rate=jnp.asarray([0.0, viscosity / mass]),
        force=jnp.asarray([0.0, 1.0 / mass]),
        piston_displacement=output([-1.0, 0.0], base=1.0),
        piston_velocity=output([0.0, -1.0], rate=1.0),
        body_velocity=output([0.0, 1.0]),
        relative_velocity=output([0.0, -1.0], rate=1.0),
        working_space=output([-1.0, 0.0], base=1.0),
        acceleration=output(to_body, k / mass, viscosity / mass, 1.0 / mass),
        tyre=output([0.0, 0.0]),
    )
