"""Random numbers that stay the same under every version of numpy, on every machine.

Numpy promises the raw integers of a seeded bit generator for all time, but not the numbers that
its distributions make of them.  Here twelve 16-bit integers are added: their sum has a standard
deviation of 2¹⁶ within 2·10⁻¹⁰ and is near enough to normal for noise (kurtosis 2.9, never beyond
6 standard deviations), and integers are exact.
"""

import numpy as np
from jaxtyping import Float, Int


class Stream:
    """A stream of random numbers of its own, named by integers.

    Args:
        key: The campaign's seed, then what the stream is for.
    """

    def __init__(self, *key: int) -> None:
        self._bits = np.random.PCG64(np.random.SeedSequence(list(key)))

    def normal(self, count: int) -> Float[np.ndarray, " n"]:
        """[count] nearly normal numbers, mean 0, standard deviation 1."""
        raw = self._raw(3 * count).reshape(count, 3)
        total = np.zeros(count, dtype=np.int64)
        for shift in (0, 16, 32, 48):
            piece = (raw >> np.uint64(shift)) & np.uint64(0xFFFF)
            total += piece.astype(np.int64).sum(axis=1)
        return (2 * total - 12 * 0xFFFF) / 131072.0

    def one_normal(self) -> float:
        """A single number as of `normal`."""
        return float(self.normal(1)[0])

    def one_uniform(self) -> float:
        """A number in [0, 1)."""
        return float(self._raw(1)[0] >> np.uint64(11)) / 9007199254740992.0

    def order(self, count: int) -> Int[np.ndarray, " n"]:
        """[count] the integers from 0, shuffled."""
        return np.argsort(self._raw(count), kind="stable")

    def _raw(self, count: int) -> np.ndarray:
        return np.asarray(self._bits.random_raw(count), dtype=np.uint64)
