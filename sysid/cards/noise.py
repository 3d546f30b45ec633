"""How well tests repeat: what one cycle scatters by, and what is left of that in the mean cycle.

Two numbers, and never one word for both: *repeatability* is the scatter of a single cycle, the
*noise of the mean cycle* is that over the square root of the number of cycles.  Models are held
against mean cycles, so a perfect one would still err by the second.
"""

import numpy as np

from sysid.data.loops import Loops


def mean_cycle_noise(loops: Loops) -> dict[str, float]:
    """Test → noise of its mean cycle, N: repeatability/√cycles; NaN where it is not known.

    Args:
        loops: L tests.
    """
    return dict(zip(loops.ids, loops.mean_cycle_noise.tolist(), strict=True))


def repeatability_nrmse(loops: Loops) -> float | None:
    """Mean over tests of repeatability/max|F|; None where no test has a known one.

    Args:
        loops: L tests.
    """
    return _mean_share(loops, loops.noise_floor)


def mean_cycle_noise_nrmse(loops: Loops) -> float | None:
    """Mean over tests of the noise of the mean cycle over max|F|; None where none is known.

    Args:
        loops: L tests.
    """
    return _mean_share(loops, loops.mean_cycle_noise)


def _mean_share(loops: Loops, noise: np.ndarray) -> float | None:
    share = noise / np.abs(loops.force).max(axis=1, initial=0.0)
    known = share[np.isfinite(share)]
    return float(np.mean(known)) if known.size else None
