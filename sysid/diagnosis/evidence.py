"""A campaign as a diagnosis sees it: measured harmonics, and models simulated in the same ones."""

from dataclasses import dataclass, fields
from functools import partial
from typing import Final

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from sysid.data.loops import Loops
from sysid.diagnosis.prototypes import Magnitudes, magnitudes
from sysid.identification.conditions import conditions
from sysid.likelihood.observed import Observed, observe
from sysid.models.damper import Damper
from sysid.models.simulate import simulate
from sysid.motion.history import RunHistory
from sysid.motion.motion import Motion

FEWEST_CONDITIONS: Final = 4
"""Amplitudes and frequencies below which each is held out in parts, by temperature."""
WARMER: Final = 5.0
"""K, range of temperatures from which a condition has parts."""


@dataclass(frozen=True, kw_only=True)
class Evidence(Observed):
    """What a diagnosis knows of measured loops beside their harmonics.

    Attributes:
        condition: [L] number of the condition that a test is held out with (`held_together`).
        peak: [L] N, max|F|.
        size: Magnitudes of the campaign.
        history: Of the tests; None where their order is not known.
    """

    condition: Int[np.ndarray, " loop"]
    peak: Float[np.ndarray, " loop"]
    size: Magnitudes
    history: RunHistory | None

    @property
    def ordered_condition(self) -> Int[np.ndarray, " loop"]:
        """[L] number of the condition by amplitude, frequency, temperature, as tests may come."""
        numbers = np.unique(self.condition)
        warm = np.nan_to_num(self.loops.temperature)
        amplitude, frequency, temperature = (
            np.array([z[self.condition == c].mean() for c in numbers])
            for z in (self.loops.amplitude, self.loops.frequency, warm)
        )
        rank = np.empty(numbers.size, dtype=int)
        rank[np.lexsort((temperature, frequency, amplitude))] = np.arange(numbers.size)
        return rank[np.searchsorted(numbers, self.condition)]

    def signature(self, damper: Damper) -> Float[np.ndarray, "loop m"]:
        """[F − F without the last effect]/its size, N per unit of the size."""
        return self.of_tests(lambda some: _signature(damper, some, self.columns))

    def simulated(self, damper: Damper) -> Float[np.ndarray, "loop point"]:
        """Force of a model in free run, N."""
        return self.of_tests(partial(simulate, damper))

    def energy(self, residual: Float[np.ndarray, "loop m"]) -> float:
        """Σ ‖r‖²/max|F|² over tests."""
        return float(np.sum(np.sum(residual**2, axis=1) / self.peak**2))

    def errors(self, damper: Damper, *, offset: bool = True) -> Float[np.ndarray, " loop"]:
        """RMSE/max|F| of each test in free run, on the points that are simulated.

        Args:
            damper: The model.
            offset: Count what is constant through a test; else its shape alone.
        """
        return self.errors_and_shapes(damper)[0 if offset else 1]

    def errors_and_shapes(self, damper: Damper) -> Float[np.ndarray, "both loop"]:
        """The same both ways: [0] counting what is constant through a test, [1] not."""
        residual = self.force - self.simulated(damper)
        squares = np.mean(residual**2, axis=1)
        shapes = np.maximum(squares - residual.mean(axis=1) ** 2, 0.0)
        return np.sqrt([squares, shapes]) / self.peak


def held_together(loops: Loops) -> Int[np.ndarray, " loop"]:
    """Number of the condition of each test: its amplitude and frequency, with all currents.

    A sweep over temperature has few of these, and what predicts the one from the other is
    extrapolated.  There each is cut into parts from cold to warm, with all their currents, so that
    a test is predicted from warmer and from colder ones, and from the other excitations.

    Args:
        loops: L tests.
    """
    number = conditions(loops)
    count = int(number.max()) + 1
    if count >= FEWEST_CONDITIONS or np.isnan(loops.temperature).any():
        return number
    parts = -(-2 * FEWEST_CONDITIONS // count)
    cut = np.empty_like(number)
    for k in range(count):
        here = np.flatnonzero(number == k)
        warm = loops.temperature[here]
        if np.ptp(warm) < WARMER:
            cut[here] = k * parts
            continue
        share = (warm - warm.min()) / np.ptp(warm)
        cut[here] = k * parts + np.minimum((share * parts).astype(int), parts - 1)
    return np.unique(cut, return_inverse=True)[1]


def gather(loops: Loops, history: RunHistory | None = None, points: int | None = None) -> Evidence:
    """Prepare loops for a diagnosis.

    Args:
        loops: L tests on J phase points, J even.
        history: Of the L tests, if their order is known.
        points: To simulate on; `observed.POINTS` where the loops have as many, if not given.
    """
    observed = observe(loops, history, points)
    own = {z.name: getattr(observed, z.name) for z in fields(observed)}
    return Evidence(
        **own,
        condition=held_together(loops),
        peak=np.abs(loops.force).max(axis=1),
        size=magnitudes(loops),
        history=history,
    )


@eqx.filter_jit
def _signature(damper: Damper, motion: Motion, columns: Array) -> Array:
    *others, effect = damper.effects
    symbol = effect.facts.size
    size = getattr(effect, symbol)
    none = eqx.tree_at(lambda e: getattr(e, symbol), effect, jnp.zeros_like(size))
    absent = Damper(damper.valve, (*others, none))
    return (damper.force(motion) - absent.force(motion)) @ columns / size
