"""Names for the shapes and types of arrays that signatures use."""

from typing import TypeAlias

import numpy as np
from jaxtyping import Array, Float

Scalar: TypeAlias = Float[Array, ""]
Vector: TypeAlias = Float[Array, " n"]
Matrix: TypeAlias = Float[Array, "m n"]
Signal: TypeAlias = Float[Array, "*batch n"] | Float[np.ndarray, "*batch n"]
"""A quantity on one phase or time grid for each test of a batch."""

NumpyVector: TypeAlias = Float[np.ndarray, " n"]
NumpyMatrix: TypeAlias = Float[np.ndarray, "m n"]
