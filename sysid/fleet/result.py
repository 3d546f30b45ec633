"""What a batched fit of a fleet returns."""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from sysid.identification.problem import Weights
from sysid.identification.result import Basin, Result
from sysid.models.coordinates import Reference
from sysid.models.generalized import Generalized
from sysid.models.generalized_coordinates import GeneralizedCoordinates, Variant
from sysid.parameters import build


@dataclass(frozen=True)
class FleetFit:
    """Identified models of D dampers.

    Attributes:
        variant: Which parameters were free.
        weights: How tests were weighted.
        parameters: [D, 16] SI, in the order of `specs(Generalized)`.
        u: [D, n] solver coordinates.
        reference: Magnitudes of every damper, [D] each.
        cost: [D] Σ w² (F − F̂)², N² for weights "paper".
        rmse: D arrays [L] N, of each test.
        nrmse: D arrays [L], over max|F|.
        results: [D] how each ended.
        starts: [D] starts made.
        basins: Of each, minima seen, best first.
        steps: [D] steps of all starts together.
    """

    variant: Variant
    weights: Weights
    parameters: Float[np.ndarray, "damper 16"]
    u: Float[np.ndarray, "damper n"]
    reference: Reference
    cost: Float[np.ndarray, " damper"]
    rmse: tuple[Float[np.ndarray, " test"], ...]
    nrmse: tuple[Float[np.ndarray, " test"], ...]
    results: tuple[Result, ...]
    starts: Int[np.ndarray, " damper"]
    basins: tuple[tuple[Basin, ...], ...]
    steps: Int[np.ndarray, " damper"]

    @property
    def dampers(self) -> int:
        """D."""
        return len(self.cost)

    def valve(self, damper: int) -> Generalized:
        """The model of one damper.

        Args:
            damper: From 0.
        """
        return build(Generalized, jnp.asarray(self.parameters[damper]))

    def coordinates(self, damper: int) -> GeneralizedCoordinates:
        """Its solver coordinates.

        Args:
            damper: From 0.
        """
        one = jax.tree.map(lambda z: float(z[damper]), self.reference)
        return GeneralizedCoordinates(one, self.variant)


def joined(parts: list[FleetFit]) -> FleetFit:
    """Fits of parts of a fleet as one.

    Args:
        parts: At least one, of the same variant and weights.
    """
    if len(parts) == 1:
        return parts[0]

    def rows(name: str) -> np.ndarray:
        return np.concatenate([getattr(part, name) for part in parts])

    return FleetFit(
        variant=parts[0].variant,
        weights=parts[0].weights,
        parameters=rows("parameters"),
        u=rows("u"),
        reference=jax.tree.map(lambda *z: np.concatenate(z), *(p.reference for p in parts)),
        cost=rows("cost"),
        rmse=tuple(one for part in parts for one in part.rmse),
        nrmse=tuple(one for part in parts for one in part.nrmse),
        results=tuple(one for part in parts for one in part.results),
        starts=rows("starts"),
        basins=tuple(one for part in parts for one in part.basins),
        steps=rows("steps"),
    )
