"""Tests that could be run next, within the limits of rig and damper."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, get_args

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from sysid.motion.history import RunHistory, with_history
from sysid.motion.motion import Motion, sine_motion
from sysid.motion.time_motion import time_motion
from sysid.planning.limits import Limits

Kind = Literal["sine", "triangle", "current_step", "rod_disconnected"]
KINDS: Final[tuple[Kind, ...]] = get_args(Kind)
ROUND: Final = (1.0, 1.5, 2.0, 3.0, 5.0, 7.5)
"""Numbers that rigs are set to, in every decade."""
LEVELS: Final = 4
"""Currents that are tried at most."""
POINTS: Final = 360
"""A cycle."""
Cycle = Float[np.ndarray, " phase"]
"""A quantity over one."""
CORNER: Final = 9
"""Harmonic up to which a triangle goes: a rig rounds its corners."""
ORDER: Final = np.arange(1, CORNER + 1, 2)
"""Of its harmonics."""
WAVES: Final = (
    (-1.0) ** (ORDER // 2) / ORDER**2 * np.sinc(ORDER / (CORNER + 2.0))
)  # Lanczos' factors: without them the speed would overshoot by a sixth (Gibbs)
TRIANGLE: Final = WAVES / (WAVES @ (-1.0) ** (ORDER // 2))
"""Displacement of a triangle of amplitude one, Σ TRIANGLE_k sin(ORDER_k φ)."""
STEEPEST: Final = float(
    (np.cos(np.outer(np.linspace(0.0, np.pi, 721), ORDER)) @ (ORDER * TRIANGLE)).max()
)
"""Its largest slope, per rad; 2/π in a triangle with sharp corners."""


@dataclass(frozen=True)
class Candidate:
    """A test.

    Attributes:
        kind: "sine"; "triangle" (constant speed); "current_step" (a sine wave with the current
            switched on when the rod is half way in and off half way out); "rod_disconnected" (a
            sine wave with nothing in the rig but its own rod end and load cell).
        amplitude: m.
        frequency: Hz.
        current: A.
    """

    kind: Kind
    amplitude: float
    frequency: float
    current: float

    @property
    def speed(self) -> float:
        """Largest, m/s."""
        part = STEEPEST if self.kind == "triangle" else 1.0
        return float(2.0 * np.pi * part * self.amplitude * self.frequency)


def candidates(limits: Limits, kinds: Sequence[Kind] = KINDS) -> tuple[Candidate, ...]:
    """Every test that limits allow, at round amplitudes and frequencies."""
    return tuple(c for c in _grid(limits, kinds) if c.speed <= limits.velocity)


def _grid(limits: Limits, kinds: Sequence[Kind]) -> Iterator[Candidate]:
    amplitudes = [1e-3 * a for a in round_numbers(*(1e3 * z for z in limits.amplitude))]
    currents = spread(limits.current, LEVELS)
    for kind in kinds:
        for amplitude in amplitudes:
            for frequency in round_numbers(*limits.frequency):
                if kind == "rod_disconnected":
                    yield Candidate(kind, amplitude, frequency, 0.0)
                    continue
                for current in currents:
                    if kind != "current_step" or current > 0.0:
                        yield Candidate(kind, amplitude, frequency, current)


def round_numbers(low: float, high: float) -> list[float]:
    """Numbers that rigs are set to between two, and the upper one itself, rounded down."""
    decades = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    found = [float(f"{z * 10.0**n:.3g}") for n in decades for z in ROUND]
    return sorted({z for z in found if low <= z <= high} | {_below(high)} - {0.0})


def _below(limit: float) -> float:
    """The largest number of three digits that does not exceed a limit."""
    near = float(f"{limit:.3g}")
    step = 10.0 ** (np.floor(np.log10(limit)) - 2.0)
    return near if near <= limit else float(f"{near - step:.3g}")


def spread(levels: Sequence[float], most: int) -> tuple[float, ...]:
    """So many of them at most, the ends among them."""
    places = np.unique(np.round(np.linspace(0, len(levels) - 1, most)).astype(int))
    return tuple(levels[k] for k in places)


def motion_of(tests: Sequence[Candidate], temperature: float) -> Motion:
    """One steady cycle of each of some tests of one kind, [C, J].

    They come after all tests of the campaign, and their current is raised from none.

    Args:
        tests: All of the same kind.
        temperature: °C; NaN if unknown.
    """
    kind = tests[0].kind
    amplitude, frequency, current = (
        np.array([getattr(t, name) for t in tests])
        for name in ("amplitude", "frequency", "current")
    )
    warm = np.full(len(tests), temperature)
    if kind in ("sine", "rod_disconnected"):
        motion = sine_motion(amplitude, frequency, current, warm, POINTS)
    else:
        parts = [_cycle(t, temperature) for t in tests]
        motion = jax.tree.map(lambda *z: jnp.stack(z), *parts)
    motion = with_history(motion, RunHistory(np.ones(len(tests)), np.sign(current)))
    if kind == "current_step":  # raised on the way in, lowered on the way out
        motion = replace(motion, ramp=jnp.where(motion.current != 0.0, 1.0, -1.0))
    return motion


def _cycle(test: Candidate, temperature: float) -> Motion:
    phase = 2.0 * np.pi * np.arange(POINTS) / POINTS
    omega = 2.0 * np.pi * test.frequency
    triangle = test.kind == "triangle"
    order = ORDER if triangle else np.array([1])
    size = test.amplitude * (TRIANGLE if triangle else np.ones(1))
    waves = np.outer(phase, order)
    on = np.sin(phase) > 0.5 if test.kind == "current_step" else np.ones(phase.size, dtype=bool)
    return two_cycles(
        np.sin(waves) @ size,
        np.cos(waves) @ (omega * order * size),
        -np.sin(waves) @ ((omega * order) ** 2 * size),
        np.where(on, test.current, 0.0),
        temperature,
        test.frequency,
    )


def two_cycles(
    displacement: Cycle,
    velocity: Cycle,
    acceleration: Cycle,
    current: Cycle | float,
    temperature: float,
    frequency: float,
) -> Motion:
    """A cycle twice, on its own time grid: what has a memory has forgotten its start in the second.

    Args:
        displacement: [J] m, `POINTS` of them, relative to the centre.
        velocity: [J] m/s.
        acceleration: [J] m/s².
        current: [J] A, or one value.
        temperature: °C; NaN if unknown.
        frequency: Hz.
    """
    motion = time_motion(
        np.arange(2 * POINTS) / (POINTS * frequency),
        np.tile(displacement, 2),
        velocity=np.tile(velocity, 2),
        acceleration=np.tile(acceleration, 2),
        current=np.tile(np.broadcast_to(current, POINTS), 2),
        temperature=temperature,
    )
    return eqx.tree_at(lambda m: m.frequency, motion, jnp.full(1, frequency))


def second_cycle(motion: Motion, force: jax.Array) -> jax.Array:
    """Forces on one cycle, [..., J] N, whatever was simulated before it."""
    return force if motion.periodic else force[..., POINTS:]


def batches(tests: Sequence[Candidate], size: int) -> Iterator[list[Candidate]]:
    """Tests of one kind, so many at a time; the last ones again until a batch is full.

    Equal shapes need one compiled program.
    """
    for kind in dict.fromkeys(t.kind for t in tests):
        own = [t for t in tests if t.kind == kind]
        for first in range(0, len(own), size):
            part = own[first : first + size]
            yield [*part, *([part[-1]] * (size - len(part)))]
