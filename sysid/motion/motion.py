"""What a damper is subjected to: motion, current and temperature on one grid."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.data.loops import Loops


class Motion(eqx.Module):
    """Motion of the piston, and what acts on it, for a batch of tests.

    Compression is positive.  Arrays are [..., n]; those marked [..., 1] may have one value a test.

    Attributes:
        displacement: m, relative to the centre of the test.
        velocity: m/s.
        acceleration: m/s².
        acceleration_sign: −1, 0 or 1: sgn ẍ as W11 Eq. 7 needs it.  On a loop it is minus the
            sign of the displacement's fundamental, 0 at 0, so that harmonics of the actuator do
            not flip the hysteresis.
        peak_velocity: v_m of W11 Eq. 10, m/s, [..., 1] on loops.
        current: A, [..., 1] where constant.
        temperature: °C, [..., 1] where constant; NaN where unknown.
        time: s, from the start of the cycle or of the record.
        frequency: Hz, [..., 1], of a periodic motion; NaN where it is not.
        periodic: The grid is one whole cycle in equal steps: the last point precedes the first.
        run_share: Place of the test in its campaign, 0 (first) to 1 (last), [..., 1]; None where
            unknown, as the two below.
        ramp: 1 where the current was last raised, −1 where it was lowered, 0 before, [..., 1] where
            it is constant.
        cycle: Number of the cycle in its test, from 0, [..., 1]; or, at every point, how many
            cycles ago the first one was half over.
        travel: m, of the valve from each point to the next one, where that is not the change of
            `displacement`, because play or air holds the valve or the velocity is late.
        share: Part of the time about each point of a cycle in which the valve moves at all, 0 to 1;
            the velocity is the mean over all of it.  None where it always does.
    """

    displacement: Float[Array, "*batch n"]
    velocity: Float[Array, "*batch n"]
    acceleration: Float[Array, "*batch n"]
    acceleration_sign: Float[Array, "*batch n"]
    peak_velocity: Float[Array, "*batch m"]
    current: Float[Array, "*batch c"]
    temperature: Float[Array, "*batch t"]
    time: Float[Array, "*batch n"]
    frequency: Float[Array, "*batch f"]
    periodic: bool = eqx.field(static=True)
    run_share: Float[Array, "*batch h"] | None = None
    ramp: Float[Array, "*batch r"] | None = None
    cycle: Float[Array, "*batch k"] | None = None
    travel: Float[Array, "*batch n"] | None = None
    share: Float[Array, "*batch n"] | None = None

    @property
    def strides(self) -> Float[Array, "*batch n"]:
        """Travel of the valve from each point to the next, m; of no meaning after a record's last.

        What has a state moves by these, and `displacement` is its place.
        """
        if self.travel is not None:
            return self.travel
        return strides_of(self.displacement)

    @property
    def path(self) -> Float[Array, "*batch n"]:
        """Displacement of the valve itself by its `strides`, from the first point on, m."""
        if self.travel is None:
            return self.displacement
        gone = jnp.cumsum(self.travel, axis=-1)
        first = self.displacement[..., :1]
        return jnp.concatenate([first, first + gone[..., :-1]], axis=-1)

    def strides_to(self, displacement: Float[Array, "*batch n"]) -> Float[Array, "*batch n"]:
        """What `strides` become where the place is another one, m."""
        return self.strides + strides_of(displacement - self.displacement)

    def moved(
        self,
        displacement: Float[Array, "*batch n"],
        velocity: Float[Array, "*batch n"],
        acceleration: Float[Array, "*batch n"],
    ) -> "Motion":
        """The same test at another place, m, m/s and m/s²; travel changes as the place does.

        The velocity is that of all of the time about a point: of a share nothing is known any more.
        """
        travel = None if self.travel is None else self.strides_to(displacement)
        return eqx.tree_at(
            lambda m: (m.displacement, m.velocity, m.acceleration, m.travel, m.share),
            self,
            (displacement, velocity, acceleration, travel, None),
            is_leaf=lambda z: z is None,
        )


def strides_of(displacement: Float[Array, "*batch n"]) -> Float[Array, "*batch n"]:
    """Change of a displacement from each point to the next, and from the last to the first, m."""
    return jnp.roll(displacement, -1, axis=-1) - displacement


def fundamental_sign(points: int) -> np.ndarray:
    """Sign of sin φ on the grid φ_j = 2πj/J, [J], exactly 0 where sin φ is."""
    half = points / 2
    j = np.arange(points)
    return np.where(j == 0, 0.0, np.where(j < half, 1.0, np.where(j > half, -1.0, 0.0)))


def loop_motion(loops: Loops) -> Motion:
    """The motion of steady loops, [L, J]; v_m = Aω per loop (reading of W11 Eq. 10)."""
    sign = np.broadcast_to(-fundamental_sign(loops.force.shape[1]), loops.force.shape)
    return Motion(
        displacement=jnp.asarray(loops.displacement),
        velocity=jnp.asarray(loops.velocity),
        acceleration=jnp.asarray(loops.acceleration),
        acceleration_sign=jnp.asarray(sign),
        peak_velocity=jnp.asarray(loops.peak_velocity[:, None]),
        current=jnp.asarray(loops.current[:, None]),
        temperature=jnp.asarray(loops.temperature[:, None]),
        time=jnp.asarray(cycle_time(loops.frequency, loops.force.shape[1])),
        frequency=jnp.asarray(loops.frequency[:, None]),
        periodic=True,
    )


def cycle_time(frequency: Float[np.ndarray, " loop"], points: int) -> np.ndarray:
    """Time of each of J points of one cycle, [L, J] s."""
    return np.arange(points)[None, :] / (points * frequency[:, None])


def sine_motion(
    amplitude: Float[np.ndarray, " loop"] | float,
    frequency: Float[np.ndarray, " loop"] | float,
    current: Float[np.ndarray, " loop"] | float,
    temperature: Float[np.ndarray, " loop"] | float | None = None,
    points: int = 360,
) -> Motion:
    """Pure sine waves x = A sin ωt, one steady cycle a test.

    Args:
        amplitude: [L] m.
        frequency: [L] Hz.
        current: [L] A.
        temperature: [L] °C; NaN if not given.
        points: Points a cycle, J.

    Returns:
        Arrays [L, J], phase φ_j = 2πj/J.
    """
    a, f, i = (
        np.atleast_1d(np.asarray(z, dtype=np.float64)) for z in (amplitude, frequency, current)
    )
    a, f, i = np.broadcast_arrays(a, f, i)
    t = np.full(a.shape, np.nan) if temperature is None else np.broadcast_to(temperature, a.shape)
    phase = 2.0 * np.pi * np.arange(points) / points
    omega = 2.0 * np.pi * f[:, None]
    x = a[:, None] * np.sin(phase)
    return Motion(
        displacement=jnp.asarray(x),
        velocity=jnp.asarray(omega * a[:, None] * np.cos(phase)),
        acceleration=jnp.asarray(-(omega**2) * x),
        acceleration_sign=jnp.asarray(np.broadcast_to(-fundamental_sign(points), x.shape)),
        peak_velocity=jnp.asarray(omega * a[:, None]),
        current=jnp.asarray(i[:, None]),
        temperature=jnp.asarray(t[:, None]),
        time=jnp.asarray(cycle_time(f, points)),
        frequency=jnp.asarray(f[:, None]),
        periodic=True,
    )
