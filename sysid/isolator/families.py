"""Controllers with the settings that a study sweeps."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, Literal, TypeAlias

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from sysid.data.supply import same_current
from sysid.isolator.controllers.base import AbstractController
from sysid.isolator.controllers.gain_schedule import (
    SPEED,
    TEMPERATURE,
    GainSchedule,
    schedule,
)
from sysid.isolator.controllers.on_off import OnOff
from sysid.isolator.controllers.passive import Passive
from sysid.isolator.controllers.pid import GAINS, pid
from sysid.isolator.controllers.proportional import FEEDBACK, FEEDFORWARD, proportional
from sysid.isolator.lumped_step import LumpedStep, lumped_step
from sysid.isolator.plant import Number
from sysid.isolator.pointwise_step import PointwiseStep
from sysid.models.lumped import Lumped

Name: TypeAlias = Literal["P", "PID", "GS", "OO", "passive"]
CONTROLLED: Final[tuple[Name, ...]] = ("P", "PID", "GS", "OO")
IN_WORDS: Final[Mapping[str, str]] = {
    "P": "proportional", "PID": "PID", "GS": "gain scheduling", "OO": "on/off",
    "passive": "constant current", "ideal": "ideal skyhook",
}  # fmt: skip
DAMPINGS: Final = (1000.0, 1400.0, 2000.0, 2500.0, 3000.0, 3500.0, 5000.0, 7000.0, 10000.0)
"""D, N·s/m: the paper's range, 1 to 3.5 kN·s/m, and on until all curves share working spaces."""
ON_CURRENTS: Final = (0.01, 0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3, 0.4)
"""I_max, A; the paper shows 0.2 A."""
FURTHER_ON: Final = (0.6, 0.8, 1.0, 1.5, 2.0, 3.0, 4.0)
"""A, as far as `OF_LARGEST` of a damper that takes more than the paper's, whose largest is 1 A."""
OF_LARGEST: Final = 0.4
"""The paper's part of its largest current that on/off goes to."""
CURRENTS: Final = (0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5)
"""A, of the constant current."""


@dataclass(frozen=True)
class Gains:
    """What the controllers are built with beside their set points; defaults are the paper's.

    Attributes:
        feedback: B of P.
        feedforward: G of P, A/N.
        pid: K_p A/N, K_i A/(N s), K_d A s/N.
        speed: v_p of the table, m/s.
        temperature: °C of the table.
    """

    feedback: float = FEEDBACK
    feedforward: float = FEEDFORWARD
    pid: tuple[float, float, float] = GAINS
    speed: float = SPEED
    temperature: float = TEMPERATURE


PAPER: Final = Gains()


@dataclass(frozen=True)
class Family:
    """One controller at some set points.

    Attributes:
        name: Short.
        set_points: D in N·s/m, or currents in A.
        unit: Of them.
        controllers: The same, one module whose arrays have the set points in front.
    """

    name: str
    set_points: tuple[float, ...]
    unit: str
    controllers: AbstractController

    @property
    def words(self) -> str:
        """Its name in words."""
        return IN_WORDS.get(self.name, self.name)


Tabled: TypeAlias = Lumped | LumpedStep | PointwiseStep
"""What gain scheduling can read a table from; the model itself at the gains' temperature."""


def table_of(damper: Tabled, gains: Gains = PAPER) -> tuple[np.ndarray, np.ndarray]:
    """Force and current of a gain schedule, [m] N and [m] A, from a damper at a temperature.

    Raises:
        DataError: Its force does not rise with current.
    """
    if isinstance(damper, Lumped):
        damper = lumped_step(damper, jnp.asarray(gains.temperature))
    currents = damper.currents
    force = np.asarray(damper.at_speed(gains.speed, jnp.asarray(currents)))
    return schedule(currents, force, np.zeros(len(currents)), gains.speed)


def family(
    name: Name,
    valve: Tabled,
    gains: Gains = PAPER,
    set_points: tuple[float, ...] | None = None,
) -> Family:
    """A controller at its usual set points; currents end at the damper's largest one.

    Where that is larger than the paper's, on/off goes on to the same part of it.

    Args:
        name: Which.
        valve: Whose table gain scheduling reads, and whose currents limit the others.
        gains: Of the controllers.
        set_points: Others than the paper's range.

    Raises:
        DataError: A table of gain scheduling cannot be made.
    """
    usual = {"OO": _on_currents(max(valve.currents)), "passive": CURRENTS}.get(name, DAMPINGS)
    points = usual if set_points is None else set_points
    of_current = name in ("OO", "passive")
    if of_current:
        points = tuple(dict.fromkeys(min(i, max(valve.currents)) for i in points))
    return Family(
        name, points, "A" if of_current else "N·s/m",
        eqx.filter_vmap(_maker(name, valve, gains))(jnp.asarray(points)),
    )  # fmt: skip


def _on_currents(largest: float) -> tuple[float, ...]:
    most = OF_LARGEST * (largest + same_current(largest))
    return (*ON_CURRENTS, *(i for i in FURTHER_ON if i <= most))


def _maker(name: Name, valve: Tabled, gains: Gains) -> Callable[[Number], AbstractController]:
    if name == "P":
        return lambda d: proportional(d, gains.feedback, gains.feedforward)
    if name == "PID":
        return lambda d: pid(d, gains.pid)
    if name == "OO":
        return OnOff
    if name == "passive":
        return Passive
    forces, currents = (jnp.asarray(z) for z in table_of(valve, gains))
    return lambda d: GainSchedule(d, forces, currents)
