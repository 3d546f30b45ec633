"""Effects of a card that have no say on a given motion, because the motion does not tell enough."""

from typing import Final

import numpy as np

from sysid.effects.base import AbstractEffect
from sysid.effects.reference_temperature import REFERENCE
from sysid.models.damper import Damper
from sysid.motion.motion import Motion

NEED_FREQUENCY: Final = ("frequency_law", "waveform_distortion")
NEED_TEMPERATURE: Final = (
    "gas_temperature", "viscosity_temperature", "yield_temperature", "stiffness_temperature",
)  # fmt: skip
NEED_HISTORY: Final = {
    "magnetic_hysteresis": "ramp",
    "first_cycle_breakaway": "cycle",
    "self_heating": "cycle",
    "run_drift": "run_share",
}
"""Id → what the motion must tell."""


def assumed_temperature(damper: Damper) -> float | None:
    """°C at which a damper is simulated where nobody tells; None where it does not matter."""
    asks = damper.valve.thermal or any(e.facts.id in NEED_TEMPERATURE for e in damper.effects)
    return REFERENCE if asks else None


def idle_effects(damper: Damper, motion: Motion) -> tuple[str, ...]:
    """Say which effects are simulated as absent, thermal ones as at the reference temperature.

    Args:
        damper: With its effects.
        motion: What it is simulated on.

    Returns:
        One sentence an effect, and one if the model itself would have to know the temperature.
    """
    told = [(effect, _reason(effect, motion)) for effect in damper.effects]
    idle = [f"{e.facts.id} has no say here: {why}" for e, why in told if why is not None]
    if damper.valve.thermal and not np.isfinite(motion.temperature).all():
        idle.insert(0, f"the temperature is not known: the model takes {REFERENCE:g} °C")
    return tuple(idle)


def _reason(effect: AbstractEffect, motion: Motion) -> str | None:
    id = effect.facts.id
    if id in NEED_HISTORY and getattr(motion, NEED_HISTORY[id]) is None:
        return "the motion does not tell what was done to the damper before"
    if id in NEED_FREQUENCY and not np.isfinite(motion.frequency).any():
        return "the motion has no frequency"
    if id in NEED_TEMPERATURE and not np.isfinite(motion.temperature).any():
        return "the temperature is not known"
    return None
