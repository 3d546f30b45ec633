"""Parameters, declared once.

A declaration `F_0: Scalar = param(symbol="F_0", unit="N", low=0.0)` in a model feeds the fit, the
intervals, the card, axis labels and tables.  Nothing else in the program repeats a symbol's unit
or bounds.

A parameter may be tabled: one value at each of some places, which stand in a static field of the
module (`places`).  Its declaration says where, `param(symbol="C_post[{} A].slope", at="currents")`,
and its field is an array.  Outside of the module every value of a table is a parameter like any
other, with a symbol of its own, so a vector, a fit or a card does not know of tables.
"""

import dataclasses
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, Final, Literal, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

Scale = Literal["linear", "log"]
M = TypeVar("M", bound=eqx.Module)
Tables = Mapping[str, Sequence[float]]
"""Name of a static field → the places that it lists."""

NO_TABLES: Final[Tables] = {}
_PLACE: Final = r"(\d+(?:\.\d+)?(?:e[+-]\d+)?)"
"""A number that is not negative, as `%g` writes it."""


@dataclasses.dataclass(frozen=True)
class ParamSpec:
    """What is known of a parameter before any data.

    Attributes:
        symbol: The paper's symbol; of an effect also the name of the field.
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
    at: str | None = None,
) -> Any:
    """Declare a parameter as a field of an equinox Module.

    Args:
        symbol: The paper's symbol; where it cannot be the field's name, letters may differ.
        name: In words.
        unit: SI symbol; "-" for a pure number.
        typical: A magnitude to measure changes by.
        low: Smallest sensible value.
        high: Largest sensible value.
        scale: "log" where ratios matter.
        at: Name of the field, declared with `places`, whose places this is a table over; the
            field holds an array then, and {} in `symbol` and `name` stands for the place.

    Returns:
        A dataclass field whose values are converted to float64 scalars, or to an array.
    """
    spec = ParamSpec(symbol, name, unit, low, high, scale, typical)
    if at is None:
        return eqx.field(converter=_as_float64, metadata={"param": spec})
    return eqx.field(converter=_as_column, metadata={"param": spec, "at": at})


def places() -> Any:
    """Declare the field that lists where parameters are tabled: increasing, not negative.

    Returns:
        A static dataclass field whose values are numbers that `%g` writes in full.
    """
    return eqx.field(static=True, converter=_as_places)


def _as_float64(value: Any) -> Any:
    """Turn numbers into float64 scalars; leave JAX's placeholders alone."""
    if isinstance(value, (int, float)):
        return jnp.asarray(np.asarray(value, dtype=np.float64))
    return value


def _as_column(value: Any) -> Any:
    """Turn sequences into float64 arrays; leave JAX's placeholders alone."""
    return (
        jnp.asarray(value, dtype=jnp.float64)
        if isinstance(value, (list, tuple, np.ndarray))
        else value
    )


def _as_places(value: Iterable[float]) -> tuple[float, ...]:
    """As cards will name them.

    Raises:
        ValueError: There are none, or they do not increase from 0 or above.
    """
    listed = tuple(float(f"{z:g}") for z in value)
    if not listed or listed[0] < 0.0 or any(b <= a for a, b in pairwise(listed)):
        raise ValueError(f"a table needs places that increase from 0 or above, not {listed}")
    return listed


def _declared(
    module: eqx.Module | type[eqx.Module],
) -> Iterator[tuple[str, ParamSpec, str | None]]:
    """Field, declaration, and name of the field that lists where it is tabled."""
    for field in dataclasses.fields(module):  # type: ignore[arg-type]  # Modules are dataclasses
        if "param" in field.metadata:
            yield field.name, field.metadata["param"], field.metadata.get("at")


def _tables(module: eqx.Module) -> Tables:
    return {at: getattr(module, at) for _, _, at in _declared(module) if at is not None}


def specs(
    module: eqx.Module | type[eqx.Module], tables: Tables = NO_TABLES
) -> tuple[ParamSpec, ...]:
    """The declared parameters of a model or an effect, in the order of their declaration.

    Args:
        module: An instance, which knows where its tables stand, or a class.
        tables: Of a class with tables, where they stand.
    """
    if isinstance(module, eqx.Module):
        tables = _tables(module)
    found: list[ParamSpec] = []
    for _, spec, at in _declared(module):
        found += [spec] if at is None else [_placed(spec, z) for z in tables[at]]
    return tuple(found)


def _placed(spec: ParamSpec, place: float) -> ParamSpec:
    symbol, name = (text.format(f"{place:g}") for text in (spec.symbol, spec.name))
    return dataclasses.replace(spec, symbol=symbol, name=name)


def tables_of(kind: type[eqx.Module], symbols: Iterable[str]) -> dict[str, tuple[float, ...]]:
    """Where the tables of a class stand, if these are its parameters' symbols.

    Args:
        kind: The class.
        symbols: In any order.  One that is none of the class's says nothing.

    Returns:
        Name of the static field → places; none where no symbol names any.
    """
    found: dict[str, set[float]] = {}
    symbols = tuple(symbols)
    for _, spec, at in _declared(kind):
        if at is not None:
            pattern = re.escape(spec.symbol).replace(re.escape("{}"), _PLACE)
            named = (re.fullmatch(pattern, symbol) for symbol in symbols)
            found.setdefault(at, set()).update(float(match[1]) for match in named if match)
    return {at: tuple(sorted(values)) for at, values in found.items()}


def values(module: eqx.Module) -> jax.Array:
    """The parameters of a module as one vector, [n], in the order of `specs`."""
    return jnp.concatenate([jnp.ravel(getattr(module, field)) for field, *_ in _declared(module)])


def as_dict(module: eqx.Module) -> dict[str, float]:
    """Symbol → value as Python floats."""
    found = np.asarray(values(module)).tolist()
    return {spec.symbol: value for spec, value in zip(specs(module), found, strict=True)}


def build(kind: type[M] | M, numbers: jax.Array | Mapping[str, float]) -> M:
    """Make a module from a vector in the order of `specs`, or from symbol → value.

    Args:
        kind: The module's class, or a module with the same tables, which a vector needs where
            there are any; it must have no other fields than parameters and their places.
        numbers: [n] values, or a mapping that names every symbol.
    """
    cls, tables = (kind, NO_TABLES) if isinstance(kind, type) else (type(kind), _tables(kind))
    if isinstance(numbers, Mapping):
        tables = tables_of(cls, numbers)
        listed: Any = [numbers[spec.symbol] for spec in specs(cls, tables)]
    else:
        listed = numbers
    fields: dict[str, Any] = {}
    first = 0
    for field, _, at in _declared(cls):
        end = first + (1 if at is None else len(tables[at]))
        fields[field] = listed[first] if at is None else listed[first:end]
        first = end
    return cls(**fields, **tables)
