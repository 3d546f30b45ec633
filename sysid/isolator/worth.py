"""What a better model is worth to a controller that reads a table made from it."""

from collections.abc import Sequence
from dataclasses import dataclass

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from sysid.isolator.base_motion import BaseMotion
from sysid.isolator.closed_loop import CLOCK, Clock
from sysid.isolator.compare import Rival, rival
from sysid.isolator.controllers.gain_schedule import GainSchedule, schedule
from sysid.isolator.families import DAMPINGS, PAPER, Family, Gains, family
from sysid.isolator.frequency_dependent import frequency_dependent
from sysid.isolator.lumped_step import lumped_step
from sysid.isolator.plant import Plant
from sysid.isolator.study import ConflictDiagram, conflict_diagram, stacked
from sysid.models.lumped import Lumped


@dataclass(frozen=True)
class Worth:
    """Gain schedules from several tables on one damper, beside P and PID.

    Attributes:
        diagram: All runs, one variant.
        over_p: Of every other controller against P, at equal working space.
    """

    diagram: ConflictDiagram
    over_p: tuple[Rival, ...]


def scheduled(
    valve: Lumped,
    name: str,
    gains: Gains = PAPER,
    *,
    yielding: float = 1.0,
    post: float = 1.0,
) -> Family:
    """A gain schedule whose table believes in other forces than the model's.

    Args:
        valve: The model.
        name: Of the schedule.
        gains: Speed and temperature of the table.
        yielding: Factor on F_y.
        post: Factor on C_post.
    """
    at = valve.F_y_intercept + valve.F_y_slope * gains.temperature
    slope = valve.C_post_intercept + valve.C_post_slope * gains.temperature
    forces, currents = schedule(
        valve.currents, yielding * np.asarray(at), post * np.asarray(slope), gains.speed
    )
    table = jnp.asarray(forces), jnp.asarray(currents)
    controllers = eqx.filter_vmap(lambda d: GainSchedule(d, *table))(jnp.asarray(DAMPINGS))
    return Family(name, DAMPINGS, "N·s/m", controllers)


def worth_of_tables(
    plant: Plant,
    valve: Lumped,
    tables: Sequence[Family],
    base: BaseMotion,
    *,
    temperature: float,
    per_decade: float,
    gains: Gains = PAPER,
    clock: Clock = CLOCK,
) -> Worth:
    """P, PID and gain schedules from some tables on a damper whose force grows with frequency.

    Args:
        plant: The plant.
        valve: The damper at 1 Hz.
        tables: Gain schedules (`scheduled`).
        base: Motions.
        temperature: Of the damper, °C.
        per_decade: ε of the damper's law of frequency; 0 for none.
        gains: Of P and PID.
        clock: Time steps.
    """
    step = frequency_dependent(lumped_step(valve, jnp.asarray(temperature)), per_decade)
    families = (family("P", valve, gains), family("PID", valve, gains), *tables)
    one = stacked([step])
    found = conflict_diagram(plant, families, one, (f"{temperature:g} °C",), base, clock)
    rivals = (rival(found, f.name, "P", 0) for f in families[1:])
    return Worth(found, tuple(r for r in rivals if r is not None))
