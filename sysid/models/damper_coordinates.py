"""Solver coordinates of a damper: those of its valve, then those of its effects."""

import math

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.effects.base import AbstractEffect
from sysid.models.coordinates import AbstractCoordinates, positive, unfraction, unpositive
from sysid.models.damper import Damper
from sysid.parameters import ParamSpec, specs


class DamperCoordinates(AbstractCoordinates[Damper]):
    """Coordinates of the valve, followed by one a parameter of every effect, in order.

    A parameter without bounds is measured in its prototype's value p, y = p u; one with a lower
    bound rises from it, y = low + (p − low) s(u)/s(1) with s = log(1 + e^u), and one between two
    bounds is a logistic share.  Prototypes of the right magnitude for the campaign therefore have
    coordinates of order one.

    Attributes:
        valve_coordinates: Of the valve.
        prototypes: Effects at values that are not zero.
    """

    valve_coordinates: AbstractCoordinates
    prototypes: tuple[AbstractEffect, ...]

    @property
    def size(self) -> int:
        """How many coordinates are free."""
        return self.valve_coordinates.size + sum(len(specs(e)) for e in self.prototypes)

    @property
    def free(self) -> tuple[str, ...]:
        """Symbols of the free parameters; those of effects with the id in front."""
        own = [f"{e.facts.id}.{s.symbol}" for e in self.prototypes for s in specs(e)]
        return (*self.valve_coordinates.free, *own)

    @property
    def ties(self) -> tuple[tuple[str, str], ...]:
        """Those of the valve."""
        return self.valve_coordinates.ties

    @property
    def remarks(self) -> tuple[str, ...]:
        """Those of the valve."""
        return self.valve_coordinates.remarks

    @property
    def confined(self) -> tuple[tuple[str, str], ...]:
        """Those of the valve."""
        return self.valve_coordinates.confined

    def valve(self, u: Float[Array, " n"]) -> Damper:
        """The damper at u."""
        first = self.valve_coordinates.size
        valve = self.valve_coordinates.valve(u[:first])
        effects = []
        for prototype in self.prototypes:
            declared = specs(prototype)
            share = u[first : first + len(declared)]
            effects.append(_moved(prototype, declared, share))
            first += len(declared)
        return Damper(valve, tuple(effects))

    def locate(self, valve: Damper) -> Float[Array, " n"]:
        """Coordinates of a damper with the same effects."""
        own = [
            _coordinate(spec, getattr(prototype, spec.symbol), getattr(effect, spec.symbol))
            for prototype, effect in zip(self.prototypes, valve.effects, strict=True)
            for spec in specs(prototype)
        ]
        base = self.valve_coordinates.locate(valve.valve)
        return jnp.concatenate([base, jnp.stack(own)]) if own else base


def _moved(
    prototype: AbstractEffect, declared: tuple[ParamSpec, ...], u: Float[Array, " k"]
) -> AbstractEffect:
    """The effect with its parameters at coordinates u."""
    values = [
        _value(spec, getattr(prototype, spec.symbol), u[k]) for k, spec in enumerate(declared)
    ]
    symbols = [spec.symbol for spec in declared]
    return eqx.tree_at(lambda e: [getattr(e, s) for s in symbols], prototype, values)


_ONE = math.log1p(math.e)
"""s(1)."""


def _value(spec: ParamSpec, p: Float[Array, ""], u: Float[Array, ""]) -> Float[Array, ""]:
    if math.isinf(spec.low):
        return p * u
    if math.isinf(spec.high):
        return spec.low + _rise(spec, p) * positive(u) / _ONE
    return spec.low + (spec.high - spec.low) * jax.nn.sigmoid(u)


def _coordinate(spec: ParamSpec, p: Float[Array, ""], y: Float[Array, ""]) -> Float[Array, ""]:
    if math.isinf(spec.low):
        return y / p
    if math.isinf(spec.high):
        return unpositive((y - spec.low) / _rise(spec, p) * _ONE)
    return unfraction((y - spec.low) / (spec.high - spec.low))


def _rise(spec: ParamSpec, p: Float[Array, ""]) -> Float[Array, ""]:
    """How far the prototype is from the bound; a typical magnitude where it is on it."""
    return jnp.where(p > spec.low, p - spec.low, spec.typical)
