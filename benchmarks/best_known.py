"""The best cost known of a random campaign: what every method is measured against."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from campaigns import Campaign

from sysid.identification.fit import fit_loops
from sysid.identification.levenberg_marquardt import Descent, descend
from sysid.identification.multistart import BLOCK, in_blocks
from sysid.identification.problem import Problem, loop_problem
from sysid.models.coordinates import AbstractCoordinates
from sysid.models.generalized import Generalized
from sysid.models.generalized_coordinates import GeneralizedCoordinates
from sysid.parameters import build

NEAR = 1e-3
"""Within 0.1 % of the best cost known counts as the global optimum."""


def polish_from_truth(campaign: Campaign) -> float:
    """Cost of the minimum that one descent from the truth ends in, N²."""
    problem = loop_problem(campaign.loops)
    coordinates = GeneralizedCoordinates(problem.reference, "asymmetric")
    start = coordinates.locate(build(Generalized, campaign.truth))
    end = _descend(coordinates, (in_blocks(problem, BLOCK),), start)
    return float(end.cost) * float(np.sum(campaign.loops.force**2))


def best_cost(campaign: Campaign, *costs: float, seeds: tuple[int, ...] = (1, 2)) -> float:
    """The lowest of `costs`, a descent from the truth, and fits with other seeds, N²."""
    others = [fit_loops(campaign.loops, seed=seed).cost for seed in seeds]
    return min([polish_from_truth(campaign), *others, *costs])


@eqx.filter_jit
def _descend(
    coordinates: AbstractCoordinates, parts: tuple[Problem, ...], start: jnp.ndarray
) -> Descent:
    return descend(coordinates, parts, start, tolerance=1e-10, max_steps=300)
