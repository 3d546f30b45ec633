"""The lumped model inside a closed loop."""

from itertools import pairwise
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.isolator.damper_step import AbstractDamperStep
from sysid.isolator.implicit_stage import Port
from sysid.isolator.plant import Number
from sysid.models.lumped import Lumped

_SLOWEST_YIELD = 0.9
_LEAST_VISCOSITY, _LEAST_YIELD, _LEAST_STIFFNESS = 1e-3, 1e-6, 1e4
"""Where lines that are carried too far end, as in the model itself."""


class ElementState(NamedTuple):
    """Compression of the spring, m, and velocity of the element, m/s."""

    u: Number
    w: Number


class Broken(eqx.Module):
    """A broken line, z(i) = z_0 + s i + Σ_j b_j max(i − i_j, 0).

    A sum of bends needs no search and no gather, so it runs at the speed of arithmetic.

    Attributes:
        value: z_0.
        slope: s.
        bends: b_j, one a knot between the first and the last.
        knots: i_j.
    """

    value: Number
    slope: Number
    bends: tuple[Number, ...]
    knots: tuple[float, ...] = eqx.field(static=True)

    def at(self, place: Number) -> Number:
        """The value there; the first and the last line go on."""
        found = self.value + self.slope * place
        for bend, knot in zip(self.bends, self.knots, strict=True):
            found = found + bend * jnp.maximum(place - knot, 0.0)
        return found


def broken(places: tuple[float, ...], heights: Float[Array, " table"]) -> Broken:
    """The line through some points; constant where there is one."""
    if len(places) == 1:
        return Broken(heights[0], jnp.zeros_like(heights[0]), (), ())
    slopes = [
        (heights[k + 1] - heights[k]) / (places[k + 1] - places[k]) for k in range(len(places) - 1)
    ]
    bends = tuple(b - a for a, b in pairwise(slopes))
    return Broken(heights[0] - slopes[0] * places[0], slopes[0], bends, places[1:-1])


class LumpedStep(AbstractDamperStep):
    r"""A bi-viscous element and a mass behind a spring, at one temperature.

        F = k u,    u̇ = v − w,    m_l ẇ = k u − χ(w)
        χ(w) = C_pre w for |w| ≤ v_y, else F_y sgn w + C_post w

    χ rises with w and is straight on either side of v_y, so a stage is solved exactly: with
    κ = k/(1 + g α k),

        (m_l + g² κ) w + g χ(w) = m_l w_K + g κ (u_K + g v_free)

    Attributes:
        tau: s.
        mass: m_l, kg.
        pre: C_pre, N·s/m.
        stiffness: k, N/m.
        post: C_post over current, N·s/m.
        yielding: F_y over current, N.
        currents: A, of the table.

    Source:
        BS09 Fig. 4, piston's side, as `sysid.models.lumped`.
    """

    tau: Number
    mass: Number
    pre: Number
    stiffness: Number
    post: Broken
    yielding: Broken
    currents: tuple[float, ...] = eqx.field(static=True)

    def start(self) -> ElementState:
        """Relaxed."""
        none = jnp.zeros_like(self.stiffness)
        return ElementState(none, none)

    def stage(
        self, known: ElementState, meets: Port, current: Number
    ) -> tuple[ElementState, Number]:
        """The next state, and the force of the spring."""
        g = meets.length
        post = jnp.clip(self.post.at(current), _LEAST_VISCOSITY, _SLOWEST_YIELD * self.pre)
        yielding = jnp.maximum(self.yielding.at(current), _LEAST_YIELD)
        give = 1.0 / (1.0 + g * meets.mobility * self.stiffness)
        soft = self.stiffness * give
        drive = self.mass * known.w + g * soft * (known.u + g * meets.velocity)
        w = element_velocity(drive, self.mass + g * g * soft, g, self.pre, post, yielding)
        u = (known.u + g * (meets.velocity - w)) * give
        return ElementState(u, w), self.stiffness * u

    def at_speed(self, speed: float, currents: Float[Array, " n"]) -> Float[Array, " n"]:
        """Force at a steady speed beyond yielding, N at each current."""
        return self.yielding.at(currents) + self.post.at(currents) * speed

    def dissipating(self, state: ElementState, current: Number) -> Number:
        """Power that the element turns into heat, χ(w) w, W."""
        post = jnp.clip(self.post.at(current), _LEAST_VISCOSITY, _SLOWEST_YIELD * self.pre)
        limit = jnp.maximum(self.yielding.at(current), _LEAST_YIELD) / (self.pre - post)
        resisting = post * state.w + (self.pre - post) * jnp.clip(state.w, -limit, limit)
        return resisting * state.w


def element_velocity(
    drive: Number, inertia: Number, length: Number, pre: Number, post: Number, yielding: Number
) -> Number:
    """Velocity w of I w + g χ(w) = drive, on either side of v_y.

    Args:
        drive: N·s.
        inertia: I, kg.
        length: g, s.
        pre: C_pre, N·s/m.
        post: C_post, N·s/m.
        yielding: F_y, N.
    """
    held = drive / (inertia + length * pre)
    flowing = (drive - jnp.sign(drive) * length * yielding) / (inertia + length * post)
    return jnp.where(jnp.abs(held) <= yielding / (pre - post), held, flowing)


def lumped_step(
    valve: Lumped, temperature: Number, stiffness_at: Number | None = None
) -> LumpedStep:
    """The model at a temperature.

    Args:
        valve: The model.
        temperature: °C.
        stiffness_at: °C, where k is taken at another temperature than C_post and F_y.
    """
    return lumped_step_at(
        valve, temperature, temperature, temperature if stiffness_at is None else stiffness_at
    )


def lumped_step_at(valve: Lumped, post: Number, yielding: Number, stiffness: Number) -> LumpedStep:
    """The model with each law at a temperature of its own, °C."""
    at = valve.C_post_intercept + valve.C_post_slope * post
    stress = valve.F_y_intercept + valve.F_y_slope * yielding
    k = jnp.maximum(valve.k_intercept + valve.k_slope * stiffness, _LEAST_STIFFNESS)
    return LumpedStep(
        tau=valve.tau,
        mass=valve.m_l,
        pre=valve.C_pre,
        stiffness=k,
        post=broken(valve.currents, at),
        yielding=broken(valve.currents, stress),
        currents=valve.currents,
    )
