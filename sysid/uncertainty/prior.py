r"""What is believed of parameters before any data: their declarations, made a density.

A declaration (`sysid/parameters.py`) tells a typical magnitude s, the smallest and the largest
value that make sense, and whether ratios or differences matter:

    ratios ("log")      ln θ ~ N(ln s, (ln 10)²)       within a factor of ten, roughly
    differences         π(θ) ∝ 1 / (1 + (θ/s)²)        Cauchy, cut off at the declaration's bounds

Both are wide: where the data determine a parameter they change nothing, and where they do not the
posterior shows the prior, which is what "not determined" looks like.

What tests see of a parameter that is large is often its inverse, as of a current far beyond theirs
at which something saturates.  Under Cauchy's density θ/s and s/θ are equally probable: half of it
is within s, and neither large nor small values are preferred.  A normal density of 10 s has nine
tenths beyond 1.3 s, where such a parameter acts on nothing in the tests; draws of others that trade
with it were then where it acts on nothing, too, and intervals left out the truth
(`benchmarks/posterior_coverage.py`).

Chains move in solver coordinates u, so the density there has the factor |∂θ/∂u|.  Some of these
do not reach all that a declaration allows (`AbstractCoordinates.confined`); the density ends there.
"""

from typing import Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from sysid.arrays import Scalar
from sysid.models.coordinates import AbstractCoordinates
from sysid.parameters import ParamSpec, specs, values

WIDE: Final = 10.0
"""The factor that ratios are believed within."""


class Prior(eqx.Module):
    """Density of solver coordinates that follows from the declarations of the free parameters.

    Attributes:
        coordinates: Map from u to the model.
        declared: Of the free parameters, in order.
        place: Their places in the vector of all parameters.
        wide: The factor that ratios are believed within.
    """

    coordinates: AbstractCoordinates
    declared: tuple[ParamSpec, ...] = eqx.field(static=True)
    place: tuple[int, ...] = eqx.field(static=True)
    wide: float = eqx.field(static=True, default=WIDE)

    def parameters(self, u: Float[Array, " n"]) -> Float[Array, " n"]:
        """Free parameters θ at u, in their units."""
        return values(self.coordinates.valve(u))[np.array(self.place)]

    def log_density(self, u: Float[Array, " n"]) -> Scalar:
        """Of u, up to a constant; −∞ where a parameter is out of its bounds or not finite."""
        theta = self.parameters(u)
        slopes = jax.jacfwd(self.parameters)(u)
        density = jnp.sum(self._each(theta)) + jnp.linalg.slogdet(slopes)[1]
        possible = jnp.all(self._inside(theta)) & jnp.isfinite(density)
        return jnp.where(possible, density, -jnp.inf)

    def words(self) -> tuple[str, ...]:
        """One line a parameter."""
        kept = dict(self.coordinates.confined)
        return tuple(_words(spec, self.wide, kept.get(spec.symbol)) for spec in self.declared)

    def _each(self, theta: Float[Array, " n"]) -> Float[Array, " n"]:
        typical = np.array([spec.typical for spec in self.declared])
        ratios = np.array([spec.scale == "log" for spec in self.declared])
        log = jnp.log(jnp.where(ratios, theta, typical))
        by_ratio = -0.5 * ((log - np.log(typical)) / np.log(self.wide)) ** 2 - log
        by_difference = -jnp.log1p((theta / typical) ** 2)
        return jnp.where(ratios, by_ratio, by_difference)

    def _inside(self, theta: Float[Array, " n"]) -> Bool[Array, " n"]:
        low = np.array([spec.low for spec in self.declared])
        high = np.array([spec.high for spec in self.declared])
        return (theta >= low) & (theta <= high)


def prior_of(
    coordinates: AbstractCoordinates, u: Float[np.ndarray, " n"], wide: float = WIDE
) -> Prior:
    """The prior of a fit's free parameters.

    Args:
        coordinates: Map from u to the model.
        u: [n] any place, to see which parameters the model has.
        wide: The factor that ratios are believed within; more than 1.
    """
    declared = specs(coordinates.valve(jnp.asarray(u)))
    symbols = [spec.symbol for spec in declared]
    place = tuple(symbols.index(symbol) for symbol in coordinates.free)
    return Prior(coordinates, tuple(declared[k] for k in place), place, wide)


def _words(spec: ParamSpec, wide: float, kept: str | None) -> str:
    if spec.scale == "log":
        shape = f"log-normal, median {spec.typical:g}, a factor of {wide:g} either way"
    else:
        shape = f"Cauchy, half of it within ± {spec.typical:g}"
    ends = []
    if np.isfinite(spec.low) and spec.scale == "linear":
        ends.append(f"not below {spec.low:g}")
    if np.isfinite(spec.high):
        ends.append(f"not above {spec.high:g}")
    if kept is not None:
        ends.append(f"by the solver's coordinates {kept}")
    return ", ".join([f"{spec.symbol} [{spec.unit}]: {shape}", *ends])
