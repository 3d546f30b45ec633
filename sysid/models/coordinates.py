"""Solver coordinates: unbounded, dimensionless numbers of order one that stand for a model.

A least-squares solver without bounds sees only these.  They are chosen by model: value-type
quantities (force at a speed, gain at a current, width at two currents) instead of the paper's
symbols, whose pairs are almost collinear, and they do not change when forces, speeds or currents
are given in other units.
"""

from abc import abstractmethod
from typing import Any, ClassVar, Generic, Literal, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.data.supply import OFF
from sysid.models.base import AbstractModel
from sysid.parameters import specs

V = TypeVar("V", bound=AbstractModel)


def _float64(value: Any) -> Any:
    """Numbers as float64 scalars, so that they are traced rather than compiled in."""
    if isinstance(value, (int, float)):
        return jnp.asarray(np.asarray(value, dtype=np.float64))
    return value


class Reference(eqx.Module):
    """Magnitudes of a campaign that make its numbers dimensionless.

    Attributes:
        force: N, RMS over the campaign.
        speed: m/s, largest peak velocity.
        current: A, largest magnitude (1 where none flows).
        length: m, largest distance from the centre of a test.
    """

    force: Scalar = eqx.field(converter=_float64)
    speed: Scalar = eqx.field(converter=_float64)
    current: Scalar = eqx.field(converter=_float64)
    length: Scalar = eqx.field(converter=_float64)


def reference_current(current: Float[np.ndarray, "..."]) -> float:
    """Largest magnitude of a campaign's currents, A; 1 where none flows.

    Args:
        current: A.
    """
    largest = float(np.abs(current).max())
    return largest if largest > OFF else 1.0


class AbstractCoordinates(eqx.Module, Generic[V]):
    """A smooth map from unbounded numbers u to a model: a valve, or a damper with effects."""

    @property
    @abstractmethod
    def size(self) -> int:
        """How many coordinates are free."""

    @property
    @abstractmethod
    def free(self) -> tuple[str, ...]:
        """Symbols of the parameters that are free, in the order of their declaration."""

    @property
    @abstractmethod
    def ties(self) -> tuple[tuple[str, str], ...]:
        """Pairs (follower, leader) of symbols that are kept equal; followers are not `free`."""

    @property
    def remarks(self) -> tuple[str, ...]:
        """What is held or assumed beyond what the variant's name says, one sentence each."""
        return ()

    @property
    def confined(self) -> tuple[tuple[str, str], ...]:
        """Pairs (symbol, within what) of free parameters that no u takes as far as their bounds.

        What a model does hardly changes beyond; a prior of the declarations ends there.
        """
        return ()

    @property
    def statics_free(self) -> bool:
        """Each test has a static force beside the model: a number of its own, fitted with the rest.

        For models that have none, while every damper with a gas accumulator has one.
        """
        return False

    @abstractmethod
    def valve(self, u: Float[Array, " n"]) -> V:
        """The model at u, [n]."""

    @abstractmethod
    def locate(self, valve: V) -> Float[Array, " n"]:
        """Coordinates of a model, [n]; values at a bound are moved just inside."""


class AllFreeCoordinates(AbstractCoordinates[V]):
    """Coordinates of a model with one variant, "full": one for every parameter, none tied.

    Attributes:
        reference: The campaign's magnitudes.
        variant: "full".
    """

    kind: ClassVar[type[eqx.Module]]
    reference: Reference
    variant: Literal["full"] = eqx.field(static=True, default="full")

    @property
    def size(self) -> int:
        """How many coordinates are free: one a parameter."""
        return len(specs(self.kind))

    @property
    def free(self) -> tuple[str, ...]:
        """All parameters."""
        return tuple(s.symbol for s in specs(self.kind))

    @property
    def ties(self) -> tuple[tuple[str, str], ...]:
        """None."""
        return ()


def positive(u: Float[Array, "..."]) -> Float[Array, "..."]:
    """log(1 + e^u): any number to a positive one; linear when large, so steps stay tame."""
    return jax.nn.softplus(u)


def unpositive(y: Float[Array, "..."], smallest: float = 1e-4) -> Float[Array, "..."]:
    """Inverse of `positive`; values below `smallest` are raised to it."""
    y = jnp.maximum(y, smallest)
    return y + jnp.log(-jnp.expm1(-y))


def unfraction(y: Float[Array, "..."], margin: float = 1e-4) -> Float[Array, "..."]:
    """Inverse of the logistic function; values are kept `margin` inside 0 … 1."""
    y = jnp.clip(y, margin, 1.0 - margin)
    return jnp.log(y) - jnp.log1p(-y)


@eqx.filter_jit
def valve_at(coordinates: AbstractCoordinates[V], u: Float[Array, " n"]) -> V:
    """`coordinates.valve(u)`, compiled once instead of operation by operation."""
    return coordinates.valve(u)


@eqx.filter_jit
def place_of(coordinates: AbstractCoordinates[V], valve: V) -> Float[Array, " n"]:
    """`coordinates.locate(valve)`, likewise."""
    return coordinates.locate(valve)
