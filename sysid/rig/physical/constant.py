"""The type of a physical constant."""

from typing import Any, TypeAlias

Constant: TypeAlias = Any
"""A number, or an array with one for each test, so that tests with different dampers run side by
side.  Arithmetic with JAX's arrays takes either, which no narrower type says."""
