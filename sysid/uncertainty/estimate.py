"""Parameters with their uncertainty, in the paper's symbols."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Estimate:
    """One parameter.

    Attributes:
        symbol: The paper's symbol.
        name: In words.
        unit: SI symbol.
        value: At the optimum.
        sd: Standard deviation; 0 where the variant holds the parameter fixed.
        low: Lower end of the 95 % interval, not below the parameter's own bound.
        high: Upper end.
        identified: The data determine it (see `Estimates.undetermined`).
    """

    symbol: str
    name: str
    unit: str
    value: float
    sd: float
    low: float
    high: float
    identified: bool


@dataclass(frozen=True)
class Estimates:
    """All parameters of a fit.

    Attributes:
        parameters: In the order of the model's declaration.
        symbols: Of the free parameters, the order of `covariance`.
        covariance: [n, n], in the parameters' units.
        interval: What the intervals are, e.g. "0.95, sandwich over conditions".
        undetermined: Directions that the data leave open, one sentence each.
    """

    parameters: tuple[Estimate, ...]
    symbols: tuple[str, ...]
    covariance: np.ndarray
    interval: str
    undetermined: tuple[str, ...]

    def to_frame(self) -> "pd.DataFrame":
        """One row a parameter."""
        import pandas as pd

        return pd.DataFrame([vars(p) for p in self.parameters])
