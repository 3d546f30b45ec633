"""Relative changes of a model's declared parameters, as coordinates that slopes are taken by."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.models.base import AbstractValve
from sysid.models.coordinates import AbstractCoordinates
from sysid.parameters import build, specs, values


class Declared(AbstractCoordinates[AbstractValve]):
    """u_k = relative change of the k-th free parameter from a model's own value.

    A solver's coordinates have no slope where a parameter is at a bound; these have.

    Attributes:
        origin: The model at u = 0.
        magnitude: [n] what a change is measured by, in the parameters' units.
        symbols: Of the free parameters.
        tied: Pairs (follower, leader) of symbols.
        statics: Each test has a static force of its own.
    """

    origin: AbstractValve
    magnitude: Float[Array, " n"]
    symbols: tuple[str, ...] = eqx.field(static=True)
    tied: tuple[tuple[str, str], ...] = eqx.field(static=True)
    statics: bool = eqx.field(static=True)

    @classmethod
    def beside(
        cls,
        valve: AbstractValve,
        coordinates: AbstractCoordinates,
        magnitude: Float[np.ndarray, " n"],
    ) -> "Declared":
        """Those parameters that are free in a fit's own coordinates.

        Args:
            valve: The model at u = 0.
            coordinates: The fit's.
            magnitude: [n] of the free parameters.
        """
        return cls(
            valve,
            jnp.asarray(magnitude),
            coordinates.free,
            coordinates.ties,
            coordinates.statics_free,
        )

    @property
    def size(self) -> int:
        """How many parameters are free."""
        return len(self.symbols)

    @property
    def free(self) -> tuple[str, ...]:
        """Their symbols."""
        return self.symbols

    @property
    def ties(self) -> tuple[tuple[str, str], ...]:
        """Pairs (follower, leader) of symbols that are kept equal."""
        return self.tied

    @property
    def statics_free(self) -> bool:
        """Each test has a static force of its own."""
        return self.statics

    def valve(self, u: Float[Array, " n"]) -> AbstractValve:
        """The model at u, [n]."""
        places = [spec.symbol for spec in specs(self.origin)]
        free = jnp.array([places.index(symbol) for symbol in self.symbols])
        theta = values(self.origin).at[free].add(self.magnitude * u)
        for follower, leader in self.tied:
            theta = theta.at[places.index(follower)].set(theta[places.index(leader)])
        return build(self.origin, theta)

    def locate(self, valve: AbstractValve) -> Float[Array, " n"]:
        """Relative changes of a model's parameters, [n]."""
        places = [spec.symbol for spec in specs(self.origin)]
        free = jnp.array([places.index(symbol) for symbol in self.symbols])
        return (values(valve) - values(self.origin))[free] / self.magnitude
