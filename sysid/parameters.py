"""Parameters, declared once.

A declaration `F_0: Scalar = param(symbol="F_0", unit="N", low=0.0)` in a model feeds the fit, the
intervals, the card, axis labels and tables.  Nothing else in the program repeats a symbol's unit
or bounds.
"""

import dataclasses
import math
from collections.abc import Mapping
from typing import Any, Literal, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

Scale = Literal["linear", "log"]
M = TypeVar("M", bound=eqx.Module)


@dataclasses.dataclass(frozen=True)
class ParamSpec:
    """What is known of a parameter before any data.

    Attributes:
        symbol: The paper's symbol, also the name of the field.
        name: In words.
        unit: SI symbol; "-" for a pure number.
        low: Smallest value that makes sense (inclusive; −inf if free).
        high: Largest value that makes sense (inclusive; +inf if free).
        scale: "log" where ratios matter rather than differences.
        typical: A magnitude to measure changes by, in `unit`.
    """

    symbol: str
    name: str
    unit: str
    low: float
    high: float
    scale: Scale
    typical: float

    def check(self, value: float) -> str | None:
        """Say in one sentence why a value cannot be this parameter's, or None if it can."""
        if not math.isfinite(value):
            return f"{self.symbol} = {value} is not a finite number"
        if not self.low <= value <= self.high:
            return f"{self.symbol} = {value:g} {self.unit} is outside [{self.low:g}, {self.high:g}]"
        return None


def param(
    *,
    symbol: str,
    name: str,
    unit: str,
    typical: float,
    low: float = -math.inf,
    high: float = math.inf,
    scale: Scale = "linear",
) -> Any:
    """Declare a parameter as a field of an equinox Module.

    Args:
        symbol: The paper's symbol; must equal the field's name.
        name: In words.
        unit: SI symbol; "-" for a pure number.
        typical: A magnitude to measure changes by.
        low: Smallest sensible value.
        high: Largest sensible value.
        scale: "log" where ratios matter.

    Returns:
        A dataclass field whose values are converted to float64 scalars.
    """
    spec = ParamSpec(symbol, name, unit, low, high, scale, typical)
    return eqx.field(converter=_as_float64, metadata={"param": spec})


def _as_float64(value: Any) -> Any:
    """Turn numbers into float64 scalars; leave JAX's placeholders alone."""
    if isinstance(value, (int, float)):
        return jnp.asarray(np.asarray(value, dtype=np.float64))
    return value


def specs(module: eqx.Module | type[eqx.Module]) -> tuple[ParamSpec, ...]:
    """The declared parameters of a model or an effect, in the order of their declaration."""
    return tuple(
        field.metadata["param"]
        for field in dataclasses.fields(module)  # type: ignore[arg-type]  # Modules are dataclasses
        if "param" in field.metadata
    )


def values(module: eqx.Module) -> jax.Array:
    """The parameters of a module as one vector, [n], in the order of `specs`."""
    return jnp.stack([jnp.asarray(getattr(module, spec.symbol)) for spec in specs(module)])


def as_dict(module: eqx.Module) -> dict[str, float]:
    """Symbol → value as Python floats."""
    return {spec.symbol: float(getattr(module, spec.symbol)) for spec in specs(module)}


def build(kind: type[M], vector: jax.Array | Mapping[str, float]) -> M:
    """Make a module from a vector in the order of `specs`, or from symbol → value.

    Args:
        kind: The module's class; it must have no other fields than parameters.
        vector: [n] values, or a mapping that names every symbol.
    """
    symbols = [spec.symbol for spec in specs(kind)]
    if isinstance(vector, Mapping):
        return kind(**{symbol: vector[symbol] for symbol in symbols})
    return kind(**{symbol: vector[k] for k, symbol in enumerate(symbols)})
