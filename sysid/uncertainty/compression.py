"""What compressing the likelihood changes of a posterior, found by reweighting its own draws."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from jaxtyping import Float

MEAN: Final = 0.02
"""Largest change of a mean that is allowed, in standard deviations."""
SD: Final = 0.02
"""Largest relative change of a standard deviation that is allowed."""


@dataclass(frozen=True)
class CompressionError:
    """How the posterior would change with the likelihood that was not compressed.

    Attributes:
        mean: Largest change of a mean, in standard deviations.
        sd: Largest relative change of a standard deviation.
        draws: Effective number of draws after reweighting; few, and this says little.
    """

    mean: float
    sd: float
    draws: float

    @property
    def small(self) -> bool:
        """Both are within their bounds."""
        return self.mean <= MEAN and self.sd <= SD

    @property
    def words(self) -> str:
        """What a reduction that went too far does to the draws."""
        return (
            "the likelihood was reduced too far: without that, a mean would move by "
            f"{self.mean:.2g} standard deviations, and a standard deviation change by "
            f"{self.sd:.2g} of itself"
        )


def compression_error(
    draws: Float[np.ndarray, "draw n"], log_ratio: Float[np.ndarray, " draw"]
) -> CompressionError:
    """Reweight draws, so that Monte Carlo error is common to both posteriors and cancels.

    Args:
        draws: Of the posterior with the compressed likelihood.
        log_ratio: Log-likelihood without compression minus with it, at each draw, up to a constant.
    """
    weight = np.exp(log_ratio - log_ratio.max())
    weight /= weight.sum()
    mean, sd = draws.mean(axis=0), draws.std(axis=0)
    other = weight @ draws
    other_sd = np.sqrt(np.maximum(weight @ (draws - other) ** 2, 0.0))
    sd = np.where(sd > 0.0, sd, 1.0)
    return CompressionError(
        mean=float(np.max(np.abs(other - mean) / sd)),
        sd=float(np.max(np.abs(other_sd / sd - 1.0))),
        draws=float(1.0 / np.sum(weight**2)),
    )
