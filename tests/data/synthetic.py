"""Records with known motion and force, for the tests of loops and quality."""

from collections.abc import Callable

import numpy as np

from sysid.data.record import Conditions, Record

Force = Callable[[np.ndarray], np.ndarray]


def knee_force(phase: np.ndarray, sharpness: float = 16.0) -> np.ndarray:
    """Force of an MR-like loop in N over phase: hysteretic knee, slope, offset, spring."""
    side = np.tanh(-np.sin(phase) / 0.02)
    knee = 1000.0 * np.tanh(sharpness * (np.cos(phase) - 0.12 * side))
    return knee + 150.0 * np.cos(phase) + 40.0 + 60.0 * np.sin(phase)


def bin_mean(force: Force, points: int) -> np.ndarray:
    """Exact mean of a force over each phase bin, by fine quadrature."""
    fine = 100
    phase = 2.0 * np.pi * ((np.arange(points * fine) + 0.5) / (points * fine) - 0.5 / points)
    return force(phase).reshape(points, fine).mean(axis=1)


def make_record(
    *,
    amplitude: float = 0.01,
    frequency: float = 2.0,
    rate: float = 1000.0,
    cycles: float = 8.3,
    start_phase: float = 0.4,
    centre: float = -0.03,
    ramp: float = 0.0,
    rest: float = 0.0,
    noise: float = 0.0,
    force: Force = knee_force,
    seed: int = 0,
    **labels: object,
) -> Record:
    """A record: rest, ramp up over `ramp` cycles, steady cycles, ramp down, rest.

    Labels (of `Conditions`) default to the true amplitude and frequency.
    """
    total = cycles + 2.0 * ramp
    span = rest + total / frequency + rest
    time = np.arange(round(span * rate)) / rate
    turn = (time - rest) * frequency
    envelope = np.clip(np.minimum(turn, total - turn) / ramp, 0.0, 1.0) if ramp else 1.0
    envelope = np.where((turn < 0) | (turn > total), 0.0, envelope)
    phase = 2.0 * np.pi * turn + start_phase
    rng = np.random.default_rng(seed)
    moving = envelope * force(phase)
    known: dict[str, object] = {"amplitude": amplitude, "frequency": frequency, "current": 0.5}
    return Record(
        id="test",
        time=time,
        displacement=centre + amplitude * envelope * np.sin(phase),
        force=moving + rng.normal(0.0, noise, time.size) if noise else moving,
        nominal=Conditions(**(known | labels)),  # pyright: ignore[reportArgumentType]
    )
