"""How smooth the errors of a valve's laws may be as well: Σ is known no better than that.

Few tests tell the correlation lengths of such errors to a factor of two, and what errors a fit may
hide goes with their square.  So what Σ says of parameters is averaged over lengths, weighted by how
probable they make the residual.

Source:
    Averaging over few places of a covariance's parameters: Rue, Martino and Chopin, Journal of the
    Royal Statistical Society B 71 (2009).
"""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.likelihood.discrepancy import Sizes
from sysid.likelihood.discrepancy_parts import Parts
from sysid.likelihood.kernel import Lengths, shortest
from sysid.likelihood.reml import Restricted
from sysid.likelihood.smoothness import MOST, STEP, Residual, Steps, Tried

FAR: Final = 3.0
"""Log-likelihood below that of the most probable lengths from which on others are left out."""
NEAR: Final = 2
"""Steps from the most probable lengths at most, a factor of two: where laws leave so little that no
length is told, any would be as good, and the longest would give the widest intervals."""
TOGETHER: Final = ((1, 1, 1, 0), (0, 0, 0, 1))
"""Directions that lengths are changed in: smoother over all excitations and currents, and over
temperature.  Each of the others on its own would say little more."""


@dataclass(frozen=True)
class Plausible:
    """One Σ of several.

    Attributes:
        weight: Its share; all together one.
        lengths: Of K_c.
        kernel: [L, L], K_c.
        sizes: Standard deviations of its parts.
        spread: [name] standard deviations of their logarithms; as good as known if None.
    """

    weight: float
    lengths: Lengths
    kernel: Float[np.ndarray, "loop loop"]
    sizes: Sizes
    spread: Float[np.ndarray, " name"] | None = None

    def of(self, parts: Parts) -> Parts:
        """What this Σ is made of, beside what another is."""
        return replace(parts, lengths=self.lengths, kernel=self.kernel)


def plausible(left: Residual, found: Restricted) -> tuple[Plausible, ...]:
    """Σs of all correlation lengths, near the most probable ones, that may be right as well.

    Args:
        left: What the model leaves, the loops with the most probable lengths.
        found: Sizes with these.
    """
    chosen = np.array(left.observed.parts.lengths)
    finite = np.isfinite(chosen)
    least = np.where(finite, shortest(thermal=left.thermal), 1.0)
    ratio = np.where(finite, chosen, 1.0) / least
    steps = (np.log(ratio) / np.log(STEP)).round().astype(int).tolist()
    best = Tried(tuple(steps), found, left.observed)
    tried: dict[Steps, Tried] = {best.steps: best}
    waiting = [best]
    while waiting:
        here = waiting.pop()
        for way in TOGETHER if left.thermal else TOGETHER[:1]:
            for sign in (1, -1):
                there = tuple(s + sign * w for s, w in zip(here.steps, way, strict=True))
                away = max(abs(a - b) for a, b in zip(there, best.steps, strict=True))
                if there in tried or away > NEAR or not 0 <= min(there) <= max(there) <= MOST:
                    continue
                tried[there] = left.at(there, here.restricted.sizes)
                if tried[there].value > best.value - FAR:
                    waiting.append(tried[there])
    values = np.array([t.value for t in tried.values()])
    weight = np.where(values > best.value - FAR, np.exp(values - values.max()), 0.0)
    weight /= weight.sum()
    return tuple(
        Plausible(
            w, t.observed.parts.lengths, t.observed.parts.kernel, t.restricted.sizes,
            t.restricted.spread,
        )
        for w, t in zip(weight.tolist(), tried.values(), strict=True)
        if w > 0.0
    )  # fmt: skip
