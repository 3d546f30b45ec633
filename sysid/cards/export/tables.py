"""A card as a look-up table of force over speed, current and temperature, and what that loses."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from sysid.cards.export.box import conditions
from sysid.cards.export.identifier import ascii_text
from sysid.cards.idle import assumed_temperature, idle_effects
from sysid.cards.schema import Card
from sysid.data.supply import OFF, same_current
from sysid.models.damper import Damper
from sysid.models.simulate import simulate
from sysid.motion.motion import sine_motion

SPEEDS: Final = 41
CURRENTS: Final = 9
TEMPERATURES: Final = 5
POINTS: Final = 720
NO_LAW: Final = "the card has no law of temperature: one table stands for all temperatures"


@dataclass(frozen=True)
class Table:
    """Force on steady loops whose peak speed is that of the card's box, without their hysteresis.

    Attributes:
        temperature: [T] °C; NaN where the card has none, one where its force depends on none.
        current: [I] A; one where all tests had one setting of the supply.
        speed: [V] m/s, of both signs.
        rising: [T, I, V] N, on the branch on which the velocity grows.
        falling: [T, I, V] N, on the other one.
        amplitude: m, of the loops.
        frequency: Hz, of the loops.
        lost: RMS of what the table leaves of the loops' force, over the largest force; the mean
            over all loops.
        energy: Energy of a cycle by the table over that of the loop, dimensionless; the mean over
            all loops.
        without_say: Sentences on effects that have no say in these loops, on a temperature that is
            not known, and on a card that has no law of it.
    """

    temperature: np.ndarray
    current: np.ndarray
    speed: np.ndarray
    rising: np.ndarray
    falling: np.ndarray
    amplitude: float
    frequency: float
    lost: float
    energy: float
    without_say: tuple[str, ...]

    @property
    def force(self) -> np.ndarray:
        """The table: the mean of both branches, [T, I, V] N."""
        return 0.5 * (self.rising + self.falling)


def table_of(card: Card, damper: Damper) -> Table:
    """Read the table off steady loops at the card's largest amplitude and speed.

    Args:
        card: With the box of conditions.
        damper: That it describes.
    """
    box = card.validity
    amplitude, peak = box.amplitude[1], box.velocity[1]
    frequency = peak / (2.0 * np.pi * amplitude)
    warm_laws = assumed_temperature(damper) is not None
    temperature = _temperatures(box.temperature, warm_laws)
    current = _currents(box.current)
    corners = np.array(getattr(damper.valve, "currents", ()))  # its laws bend there
    low, high = current[0], current[-1]
    current = np.unique(np.append(current, corners[(corners >= low) & (corners <= high)]))
    warm, driven = (z.ravel() for z in np.meshgrid(temperature, current, indexing="ij"))
    each = np.ones_like(driven)
    motion = sine_motion(amplitude * each, frequency * each, driven, warm, points=POINTS)
    force = np.asarray(simulate(damper, motion))
    velocity = np.asarray(motion.velocity)
    # φ = 0 is the centre at full speed; velocity falls until the middle of the cycle, then grows
    down = slice(0, POINTS // 2 + 1)
    up = np.r_[POINTS // 2 : POINTS, 0]
    speed = peak * np.linspace(-1.0, 1.0, SPEEDS)
    falling = np.stack([np.interp(speed, v[down][::-1], f[down][::-1])
                        for v, f in zip(velocity, force, strict=True)])  # fmt: skip
    rising = np.stack([np.interp(speed, v[up], f[up])
                       for v, f in zip(velocity, force, strict=True)])  # fmt: skip
    mean = 0.5 * (rising + falling)
    read = np.stack([np.interp(v, speed, f) for v, f in zip(velocity, mean, strict=True)])
    lost = np.sqrt(np.mean((force - read) ** 2, axis=1)) / np.abs(force).max(axis=1)
    energy = np.sum(read * velocity, axis=1) / np.sum(force * velocity, axis=1)
    shape = (temperature.size, current.size, SPEEDS)
    return Table(
        temperature, current, speed, rising.reshape(shape), falling.reshape(shape),
        amplitude, float(frequency), float(lost.mean()), float(energy.mean()),
        (*idle_effects(damper, motion), *(() if warm_laws else (NO_LAW,))),
    )  # fmt: skip


def _temperatures(span: tuple[float, float] | None, warm: bool) -> np.ndarray:
    """A grid; one temperature, the middle, where the force does not depend on it."""
    if span is None:
        return np.array([np.nan])
    if not warm or span[0] == span[1]:
        return np.array([0.5 * sum(span)])
    return np.linspace(*span, TEMPERATURES)


def _currents(span: tuple[float, float]) -> np.ndarray:
    """A grid; one current where all tests had one setting of the supply, however that scatters."""
    low, high = span
    largest = max(abs(low), abs(high))
    nothing = max(1e-3 * largest, OFF)  # 0 A is never recorded as 0
    if high - low <= same_current(largest):
        middle = 0.5 * (low + high)
        return np.array([0.0 if abs(middle) <= nothing else middle])
    return np.linspace(0.0 if abs(low) <= nothing else low, high, CURRENTS)


def table_csv(table: Table, card: Card) -> str:
    """The table as CSV, with what it loses in front; lines that begin with # are no data."""
    told = (
        f"{card.damper.name}, identified from {card.damper.campaign} by {card.software}, "
        f"model {card.model}",
        f"Force over velocity on steady loops of {1e3 * table.amplitude:.4g} mm at "
        f"{table.frequency:.4g} Hz: force_N is the mean of both branches of the loop.",
        "What this loses: a table has no memory. The force while the velocity grows and while it "
        "falls differ (the last two columns), and so does the force at other amplitudes and "
        "frequencies with the same speed; what depends on place or acceleration is lost as well.",
        f"On these loops the table is wrong by {table.lost:.1%} of the largest force (RMS), and "
        f"its energy per cycle is {table.energy:.1%} of the loop's.",
        f"Identified at {conditions(card)}. No extrapolation is meant.",
        "Compression is positive, and so is a force that resists it.",
        *(f"Note: {line}" for line in (*card.known_discrepancies, *table.without_say)),
    )
    rows = ["".join(f"# {ascii_text(line)}\n" for line in told).rstrip("\n")]
    rows.append(
        "temperature_degC,current_A,velocity_m/s,force_N,force_velocity_rising_N,"
        "force_velocity_falling_N"
    )
    mean = table.force
    for k, warm in enumerate(table.temperature.tolist()):
        for j, current in enumerate(table.current.tolist()):
            for n, speed in enumerate(table.speed.tolist()):
                values = (mean[k, j, n], table.rising[k, j, n], table.falling[k, j, n])
                forces = ",".join(f"{value:.9g}" for value in values)
                rows.append(f"{warm:g},{current:.9g},{speed:.9g},{forces}")
    return "\n".join(rows) + "\n"
