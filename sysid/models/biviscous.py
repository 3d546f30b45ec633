r"""A bi-viscous element and a mass behind a spring, solved exactly between two samples.

With x the piston's displacement, y the element's, u = x − y and w = ẏ:

    u̇ = ẋ − l F − w,    m_l ẇ = k u − χ(w),    F = k u
    χ(w) = C_post w + (C_pre − C_post) clip(w, −v_y, v_y),    v_y = F_y / (C_pre − C_post)

l F is what a leak beside the element takes up.  On each branch b of χ (1 and −1 after yield, 0
before) this is linear, χ = c w + b F_y, and ẋ is a parabola, so the solution is another parabola
and two exponentials.
"""

from typing import NamedTuple, TypeAlias

import jax.numpy as jnp
from jaxtyping import Array, Float

Number: TypeAlias = Float[Array, "..."]
_NEAR_CRITICAL = 1e-3
"""|δt|² below which hyperbolic and circular functions are taken as their common series."""


class State(NamedTuple):
    """Where the element is.

    Attributes:
        u: Compression of the spring, m.
        w: Velocity of the element, m/s.
    """

    u: Number
    w: Number


class Element(NamedTuple):
    """The numbers of an element, or of many.

    Attributes:
        stiffness: k, N/m.
        mass: m_l, kg.
        pre: C_pre, N·s/m.
        post: C_post < C_pre, N·s/m.
        yielding: F_y, N.
        leakage: l, m/(s·N), of a leak beside element and spring; None where there is none.
    """

    stiffness: Number
    mass: Number
    pre: Number
    post: Number
    yielding: Number
    leakage: Number | None = None

    @property
    def yield_velocity(self) -> Number:
        """v_y, m/s."""
        return self.yielding / (self.pre - self.post)

    @property
    def relief(self) -> Number | float:
        """Rate l k at which the leak alone relieves the spring, 1/s."""
        return 0.0 if self.leakage is None else self.leakage * self.stiffness

    def damping(self, branch: Number) -> Number:
        """Slope c of χ on a branch, N·s/m."""
        return jnp.where(branch == 0.0, self.pre, self.post)

    def acceleration(self, branch: Number, state: State) -> Number:
        """ẇ on a branch, m/s²."""
        resisting = self.damping(branch) * state.w + branch * self.yielding
        return (self.stiffness * state.u - resisting) / self.mass


class Stretch(NamedTuple):
    """One step of a grid, or all of them.

    Attributes:
        time: h, s.
        v_0: Velocity of the piston when it begins, m/s.
        v_1: m/s².
        v_2: m/s³; ẋ = v_0 + v_1 t + v_2 t².
        element: The element meanwhile.
    """

    time: Number
    v_0: Number
    v_1: Number
    v_2: Number
    element: Element

    def shifted(self, begin: Number) -> tuple[Number, Number, Number]:
        """Coefficients of ẋ in the time since `begin`, s."""
        v_1 = self.v_1 + 2.0 * self.v_2 * begin
        return self.v_0 + (self.v_1 + self.v_2 * begin) * begin, v_1, self.v_2


class Affine(NamedTuple):
    """A map of the state, z → E z + g.

    Attributes:
        uu: E, and so on.
        uw: s.
        wu: 1/s.
        ww: -.
        u: g, m.
        w: m/s.
    """

    uu: Number
    uw: Number
    wu: Number
    ww: Number
    u: Number
    w: Number

    def __call__(self, state: State) -> State:
        """Image of a state."""
        u, w = state
        return State(self.uu * u + self.uw * w + self.u, self.wu * u + self.ww * w + self.w)

    def after(self, first: "Affine") -> "Affine":
        """This map behind another one."""
        u, w = self(State(first.u, first.w))
        return Affine(
            self.uu * first.uu + self.uw * first.wu,
            self.uu * first.uw + self.uw * first.ww,
            self.wu * first.uu + self.ww * first.wu,
            self.wu * first.uw + self.ww * first.ww,
            u,
            w,
        )


def identity(like: Number) -> Affine:
    """The map that changes nothing, in the shape of an array."""
    one, none = jnp.ones_like(like), jnp.zeros_like(like)
    return Affine(one, none, none, one, none, none)


class Parabola(NamedTuple):
    """A solution without exponentials: u = p_0 + p_1 t + p_2 t², w = q_0 + q_1 t + q_2 t²."""

    p_0: Number
    p_1: Number
    p_2: Number
    q_0: Number
    q_1: Number
    q_2: Number

    def at(self, time: Number) -> State:
        """The solution after a time, s."""
        return State(
            self.p_0 + (self.p_1 + self.p_2 * time) * time,
            self.q_0 + (self.q_1 + self.q_2 * time) * time,
        )


def smooth_part(stretch: Stretch, branch: Number, begin: Number) -> Parabola:
    """What motion tends to on a branch, from a time since the step's start on, s."""
    element = stretch.element
    k, m, c = element.stiffness, element.mass, element.damping(branch)
    v_0, v_1, q_2 = stretch.shifted(begin)
    slack, inertia, relief = c / k, m / k, element.relief
    passed = 1.0 + relief * slack
    q_2 = q_2 / passed
    q_1 = (v_1 - 2.0 * (slack + relief * inertia) * q_2) / passed
    p_1, p_2 = 2.0 * inertia * q_2 + slack * q_1, slack * q_2
    held = branch * element.yielding / k + inertia * q_1
    q_0 = (v_0 - p_1 - relief * held) / passed
    return Parabola(held + slack * q_0, p_1, p_2, q_0, q_1, q_2)


def flow(stretch: Stretch, branch: Number, begin: Number, time: Number) -> Affine:
    """What becomes of a state on one branch.

    Args:
        stretch: The step.
        branch: −1, 0 or 1.
        begin: Since the step's start, s.
        time: How long, s.
    """
    element, smooth = stretch.element, smooth_part(stretch, branch, begin)
    alpha, mean, kappa = _rates(element, branch)
    even, odd = _decays(alpha, mean, kappa, time)
    uu, uw = even + alpha * odd, -odd
    wu, ww = kappa * odd, even - alpha * odd
    end = smooth.at(time)
    return Affine(
        uu,
        uw,
        wu,
        ww,
        end.u - uu * smooth.p_0 - uw * smooth.q_0,
        end.w - wu * smooth.p_0 - ww * smooth.q_0,
    )


def ringing(stretch: Stretch, branch: Number, begin: Number, state: State) -> tuple[Number, Number]:
    """Angular frequency and largest velocity of the free oscillation, rad/s and m/s.

    Args:
        stretch: The step.
        branch: −1, 0 or 1.
        begin: Since the step's start, s.
        state: At that time.

    Returns:
        Zeros where it does not oscillate.
    """
    element, smooth = stretch.element, smooth_part(stretch, branch, begin)
    alpha, _, kappa = _rates(element, branch)
    square = kappa - alpha * alpha
    rings = square > 0.0
    omega = jnp.sqrt(jnp.where(rings, square, 1.0))
    u, w = state.u - smooth.p_0, state.w - smooth.q_0
    size = jnp.hypot(w, (kappa * u - alpha * w) / omega)
    return jnp.where(rings, omega, 0.0), jnp.where(rings, size, 0.0)


def _rates(element: Element, branch: Number) -> tuple[Number, Number, Number]:
    """α and ᾱ, 1/s, half the difference and half the sum of c/m_l and l k; κ = k/m_l, 1/s²."""
    own, relief = element.damping(branch) / element.mass, element.relief
    return 0.5 * (own - relief), 0.5 * (own + relief), element.stiffness / element.mass


def _decays(alpha: Number, mean: Number, kappa: Number, time: Number) -> tuple[Number, Number]:
    """e^{−ᾱt} cosh δt and e^{−ᾱt} sinh(δt)/δ with δ² = α² − κ of either sign."""
    square = alpha * alpha - kappa
    x = square * time * time
    near = jnp.abs(x) < _NEAR_CRITICAL
    over = square > 0.0
    size = jnp.sqrt(jnp.where(near, 1.0, jnp.abs(square)))
    # ᾱ − δ = (ᾱ² − α² + κ)/(ᾱ + δ), without cancellation
    slow = jnp.where(near | ~over, mean, ((mean - alpha) * (mean + alpha) + kappa) / (mean + size))
    decay = jnp.exp(-slow * time)
    angle = size * time
    fast = jnp.exp(jnp.where(over, -2.0 * angle, 0.0))
    even = jnp.where(over, 0.5 * (1.0 + fast), jnp.cos(angle))
    odd = jnp.where(over, 0.5 * (1.0 - fast), jnp.sin(angle)) / size
    x = jnp.where(near, x, 0.0)
    even = jnp.where(near, 1.0 + x * (1 / 2 + x * (1 / 24 + x / 720)), even)
    odd = jnp.where(near, time * (1.0 + x * (1 / 6 + x * (1 / 120 + x / 5040))), odd)
    return decay * even, decay * odd
