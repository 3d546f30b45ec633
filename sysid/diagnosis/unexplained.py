"""The signature of what remains: parity, exponents, what it varies with, which law moves."""

from typing import Final

import jax
import jax.numpy as jnp
import numpy as np

from sysid.diagnosis.anova import anova
from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.exponents import exponents
from sysid.diagnosis.parity import parity_shares
from sysid.diagnosis.proposal import proposal
from sysid.diagnosis.remainder import Remainder
from sysid.diagnosis.result import Grid, Unknown
from sysid.diagnosis.state import State
from sysid.diagnosis.words import percent
from sysid.parameters import specs, values

VISIBLE: Final = 0.004
"""RMS over tests of error/max|F|, beyond noise and rig errors, from which something remains to be
said."""
STANDS_OUT: Final = 1.5
"""A parameter moves if it explains so many times what the next one does."""


def unexplained(
    evidence: Evidence, state: State, left: Remainder, before: Remainder, residual: Grid
) -> Unknown:
    """Describe what a model leaves.

    Args:
        evidence: The campaign.
        state: The final model.
        left: What it leaves.
        before: What the base model leaves.
        residual: [L, J] N, measured minus simulated.
    """
    beyond = np.sqrt(left.reducible / evidence.tests)
    loops = evidence.loops
    size = np.sqrt(np.mean(residual**2, axis=1))
    found = {e.quantity: e for e in exponents(loops, size)}
    depends = [
        e.quantity
        for e in sorted(found.values(), key=lambda e: -abs(np.nan_to_num(e.value)))
        if np.isfinite(e.value) and (e.low > 0.0 or e.high < 0.0)
    ]
    reducible = max(before.total - left.floor, 1e-300)
    share = float(np.clip(left.reducible / reducible, 0.0, 1.0))
    present = beyond > VISIBLE and left.reducible > 0.2 * left.total
    moves = _moves(evidence, state) if present else None
    because = []
    if present and left.law_shaped > 0.7:
        because.append(
            f"{percent(left.law_shaped)} of it has the shape of an error of the valve's laws "
            "(plateau, width and steepness of the loop that vary with amplitude, frequency and "
            "current otherwise than the base model says)."
        )
    return Unknown(
        present=bool(present),
        share_of_reducible=share,
        parity={str(p): float(v) for p, v in parity_shares(_even(residual)).items()},
        exponents={q: float(e.value) for q, e in found.items() if np.isfinite(e.value)},
        depends_on=tuple(depends),
        moves=moves,
        because=tuple(because),
        anova=anova(evidence, state) if present else None,
        proposal=proposal(evidence, state) if present else (),
    )


def _even(residual: Grid) -> Grid:
    """An even number of points, which parity needs."""
    return residual if residual.shape[1] % 2 == 0 else residual[:, :-1]


def _moves(evidence: Evidence, state: State) -> str | None:
    """The valve parameter whose variation from loop to loop explains most of the residual."""
    coordinates = state.coordinates.valve_coordinates
    symbols = coordinates.free
    u = jnp.asarray(state.u[: coordinates.size])

    declared = [s.symbol for s in specs(coordinates.valve(u))]
    places = np.array([declared.index(symbol) for symbol in symbols])

    def moving(z: jax.Array) -> jax.Array:
        return values(coordinates.valve(z))[places]

    back = np.linalg.pinv(np.asarray(jax.jacfwd(moving)(u)), rcond=1e-10)
    jacobian = state.gls.jacobian[:, :, : coordinates.size] @ back
    along = np.einsum("lmp,lm->lp", jacobian, state.gls.residual) ** 2
    own = np.einsum("lmp,lmp->lp", jacobian, jacobian)
    explained = np.sum(
        np.where(own > 0.0, along / np.where(own > 0.0, own, 1.0), 0.0)
        / evidence.peak[:, None] ** 2,
        axis=0,
    )
    order = np.argsort(-explained)
    if explained.size > 1 and explained[order[0]] < STANDS_OUT * explained[order[1]]:
        return None
    return str(symbols[int(order[0])])
