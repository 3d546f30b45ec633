r"""Normal equations of the generalised model from the Gram matrices of single loops.

On a loop, v_m and i are constant, so Eq. 3 has seven numbers:

    F = (G tanh(β (v + s h + b)) − O) (1 + κ± |v|)
    G = C_i F_t,  β = a/2,  h = v_h,  b = k_6 v_m,  O = k_5 C_i² F_t,  κ± = k_1c,e e^{−a_4 v_m}

with s = sgn ẍ.  The derivatives of F by these are closed products of one tanh a point, and their
8 × 8 Gram matrix (with the residual) is all that a loop says about any of the sixteen parameters:
JᵀJ = Σ_l Q_lᵀ H_l Q_l with Q_l = ∂(G, …, κ₋)/∂u of loop l.  No Jacobian of all points by all
parameters is formed: 64 instead of 289 products a point.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.fleet.stack import Stack
from sysid.models.coordinates import Reference
from sysid.models.generalized import Generalized
from sysid.models.generalized_coordinates import GeneralizedCoordinates, Variant


class Normal(eqx.Module):
    """Gauss–Newton model of a cost about a point: c + 2 gᵀδ + δᵀMδ.

    Attributes:
        matrix: [n, n] M = JᵀJ.
        gradient: [n] g = Jᵀr.
        cost: c = rᵀr, over Σ w² F².
    """

    matrix: Float[Array | np.ndarray, "*start n n"]
    gradient: Float[Array | np.ndarray, "*start n"]
    cost: Float[Array | np.ndarray, "*start"]


def normal_equations(
    variant: Variant, stack: Stack, u: Float[Array | np.ndarray, "start n"]
) -> Normal:
    """Normal equations of many starts at once.

    Args:
        variant: Of the model.
        stack: The damper of each start, S rows.
        u: [S, n] solver coordinates.
    """

    def laws(u: Array, reference: Reference, *test: Array) -> Array:
        valve = GeneralizedCoordinates(reference, variant).valve(u)
        return loop_numbers(valve, *test)

    def expanded(u: Array, reference: Reference, *test: Array) -> tuple[Array, Array]:
        q, push = jax.linearize(lambda z: laws(z, reference, *test), u)
        return q, jax.vmap(push, out_axes=-1)(jnp.eye(u.size))

    tests = (jnp.asarray(z) for z in (stack.peak_velocity, stack.current, stack.weight))
    q, by_u = jax.vmap(expanded)(jnp.asarray(u), stack.reference, *tests)
    columns = loop_columns(q, jnp.asarray(stack.velocity), stack.force, stack.sign)
    gram = columns @ jnp.swapaxes(columns, -1, -2)
    inner = gram[..., :7, :7] @ by_u
    n = u.shape[-1]
    rows = by_u.reshape(len(u), -1, n)
    return Normal(
        matrix=jnp.swapaxes(rows, -1, -2) @ inner.reshape(rows.shape),
        gradient=jnp.einsum("srn,sr->sn", rows, gram[..., :7, 7].reshape(len(u), -1)),
        cost=jnp.sum(gram[..., 7, 7], axis=-1),
    )


def loop_numbers(
    valve: Generalized,
    v_m: Float[Array, " test"],
    i: Float[Array, " test"],
    weight: Float[Array, " test"],
) -> Float[Array, "test 7"]:
    """G, β, h, b, O, κ₊, κ₋ of each loop, G and O times its weight.

    Args:
        valve: The model.
        v_m: [L] m/s.
        i: [L] A.
        weight: [L] 1/N.
    """
    gain = valve.force_gain(i)
    scaled = weight * gain * valve.transition_force(v_m)
    decay = jnp.exp(-valve.a_4 * v_m)
    columns = [
        scaled, 0.5 * valve.steepness(v_m), valve.loop_half_width(v_m, i), valve.k_6 * v_m,
        valve.k_5 * gain * scaled, valve.k_1c * decay, valve.k_1e * decay,
    ]  # fmt: skip
    return jnp.stack(columns, axis=-1)


def loop_columns(
    q: Float[Array, "*test 7"],
    v: Float[Array | np.ndarray, "*test point"],
    force: Float[Array | np.ndarray, "*test point"],
    sign: Float[Array | np.ndarray, " point"],
) -> Float[Array, "*test 8 point"]:
    """Derivatives of the force by the seven numbers of a loop, and the residual F̂ − F.

    A test of no weight has G = O = 0 and F = 0; its columns by G and O meet derivatives that are
    zero.

    Args:
        q: As from `loop_numbers`.
        v: m/s.
        force: Measured, scaled as G, dimensionless.
        sign: sgn ẍ.
    """
    G, beta, h, b, O, up, down = (q[..., k, None] for k in range(7))  # noqa: E741
    forward, speed = v >= 0.0, jnp.abs(v)
    rise = 1.0 + jnp.where(forward, up, down) * speed
    x = v + sign * h + b
    t = jnp.tanh(beta * x)
    by_x = G * (1.0 - t * t) * rise
    by_b = beta * by_x
    inner = G * t - O
    by_rise = inner * speed
    zero = jnp.zeros_like(t)
    return jnp.stack(
        [
            t * rise, by_x * x, by_b * sign, by_b, -rise,
            jnp.where(forward, by_rise, zero), jnp.where(forward, zero, by_rise),
            inner * rise - force,
        ],
        axis=-2,
    )  # fmt: skip
