"""What a fitted model leaves, ready for regression: products of columns, condition by condition.

Columns are put beside the Jacobian of the model, so that a regression on them finds only what the
model's own parameters cannot absorb.  Every test is weighted by 1/max|F|.  A condition, one
amplitude and one frequency with all currents, is the smallest thing that may be left out: tests at
other currents of the same motion are no unseen tests.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from sysid.diagnosis.evidence import Evidence
from sysid.diagnosis.state import State
from sysid.likelihood.reml import full_rank


@dataclass(frozen=True)
class Variables:
    """What a force may depend on, at every point of every loop; constant ones have one column.

    Attributes:
        position: [L, P] m.
        velocity: [L, P] m/s.
        acceleration: [L, P] m/s².
        current: [L, 1] A.
        temperature: [L, 1] °C; NaN where unknown.
        frequency: [L, 1] Hz.
    """

    position: Float[np.ndarray, "loop point"]
    velocity: Float[np.ndarray, "loop point"]
    acceleration: Float[np.ndarray, "loop point"]
    current: Float[np.ndarray, "loop 1"]
    temperature: Float[np.ndarray, "loop 1"]
    frequency: Float[np.ndarray, "loop 1"]


def variables(evidence: Evidence) -> Variables:
    """Of a campaign, on the points that are simulated."""
    loops, motion = evidence.loops, evidence.motion
    moving = (motion.displacement, motion.velocity, motion.acceleration)
    position, velocity, acceleration = (np.asarray(z)[: evidence.tests] for z in moving)
    return Variables(
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        current=loops.current[:, None],
        temperature=loops.temperature[:, None],
        frequency=loops.frequency[:, None],
    )


@dataclass(frozen=True)
class Leftover:
    """Products of [Jacobian, columns, residual] in each condition.

    Attributes:
        grams: [C, n + p + 1, n + p + 1], one a condition, in the order above.
        model: n, columns of the Jacobian (full rank).
    """

    grams: Float[np.ndarray, "condition k k"]
    model: int

    @property
    def whole(self) -> Float[np.ndarray, "k k"]:
        """Over all conditions."""
        return self.grams.sum(axis=0)

    def places(self, columns: np.ndarray) -> np.ndarray:
        """[k] places of the Jacobian and of [c] columns, in the products."""
        return np.concatenate([np.arange(self.model), self.model + np.asarray(columns, dtype=int)])

    def solved(
        self, gram: Float[np.ndarray, "k k"], columns: np.ndarray, ridge: float = 0.0
    ) -> Float[np.ndarray, " q"]:
        """Coefficients of Jacobian and [c] columns that fit the residual; ridge on these alone."""
        chosen = self.places(columns)
        left = gram[np.ix_(chosen, chosen)].copy()
        left[np.diag_indices_from(left)] += 1e-12 * np.trace(left) / len(chosen)
        own = np.arange(self.model, len(chosen))
        left[own, own] += ridge
        return np.linalg.solve(left, gram[chosen, -1])

    def held_out(self, columns: np.ndarray, ridge: float = 0.0) -> Float[np.ndarray, " condition"]:
        """Squared error in each condition, predicted by a regression on the others.

        Args:
            columns: [c] places of the terms beside the Jacobian.
            ridge: On those.
        """
        whole, chosen = self.whole, self.places(columns)
        return np.array(
            [squared_error(g, chosen, self.solved(whole - g, columns, ridge)) for g in self.grams]
        )


def squared_error(
    gram: Float[np.ndarray, "k k"], chosen: np.ndarray, c: Float[np.ndarray, " q"]
) -> float:
    """‖r − Bc‖² from products of [B, r]."""
    inner = gram[np.ix_(chosen, chosen)]
    return float(gram[-1, -1] - 2.0 * c @ gram[chosen, -1] + c @ inner @ c)


def leftover(
    evidence: Evidence,
    state: State,
    columns: Float[np.ndarray, "loop point p"],
    groups: int | None = None,
) -> Leftover:
    """Products for regressions of what a model leaves.

    Args:
        evidence: The campaign.
        state: The model, fitted for free runs.
        columns: [L, P, p] what the residual may be made of, N per unit of each coefficient.
        groups: Conditions are put together in at most so many groups; each on its own if None.
    """
    weight = 1.0 / evidence.peak[:, None, None]
    harmonics = np.moveaxis(np.moveaxis(columns, 1, 2) @ np.asarray(evidence.columns), 1, 2)
    every = np.concatenate(
        [
            full_rank(state.gls.jacobian * weight),
            harmonics * weight,
            (state.gls.residual * weight[:, :, 0])[:, :, None],
        ],
        axis=2,
    )
    places = evidence.ordered_condition
    places = places % (groups or int(places.max()) + 1)
    grams = []
    for number in np.unique(places):
        z = every[places == number].reshape(-1, every.shape[2])
        grams.append(z.T @ z)
    return Leftover(np.stack(grams), every.shape[2] - columns.shape[2] - 1)
