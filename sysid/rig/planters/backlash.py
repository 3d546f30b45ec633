"""Play between actuator and piston, in two constructions."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float

from sysid.rig.planters.bench_state import BenchState
from sysid.rig.planters.planter import Planter, Stage

Grid = Float[np.ndarray, "loop phase"]


@dataclass(frozen=True, kw_only=True)
class RodPlay(Planter):
    """Play operator on the rod: after a reversal the piston stands until the gap is crossed.

    Oil and seals hold the standing piston with the force that the valve has at rest.  In the step
    in which it starts to move the force is the mean of those at rest and in motion; a valve with a
    memory follows the mean velocity.

    Attributes:
        size: Whole gap, m.
    """

    name: ClassVar[str] = "rod_play"
    causes: ClassVar[tuple[str, ...]] = ("backlash",)
    family: ClassVar[str | None] = "lost_motion"
    stage: ClassVar[Stage] = "motion"
    size: float = 1.0e-4

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        if self.size == 0.0:
            return state
        crossed = state.travel_since_reversal
        step = np.abs(state.velocity) * state.time_step[:, None]
        share = np.clip((crossed - self.size) / np.maximum(step, 1e-12) + 0.5, 0.0, 1.0)
        held = state.with_valve(velocity=state.valve_velocity * share)
        if not state.valve.memoryless:
            return held
        moving, resting = state.valve_force(), state.valve_force(velocity=np.zeros_like(share))
        return held.adding(share * moving + (1.0 - share) * resting - held.valve_force())


@dataclass(frozen=True, kw_only=True)
class LoosePin(Planter):
    """A pin in an eye too wide: it carries nothing while it crosses the eye.

    It stays in contact after the reversal until the piston's own force on it has fallen to zero;
    then it travels the gap without force and strikes the other side.

    Attributes:
        size: Whole gap, m.
    """

    name: ClassVar[str] = "loose_pin"
    causes: ClassVar[tuple[str, ...]] = ("backlash",)
    family: ClassVar[str | None] = "lost_motion"
    stage: ClassVar[Stage] = "joint"
    size: float = 1.0e-4

    def plant(self, state: BenchState) -> BenchState:
        """The tests with the effect in them."""
        if self.size == 0.0:
            return state
        return state.recording(state.force * self.contact(state))

    def contact(self, state: BenchState) -> Grid:
        """1 where the pin carries the force, 0 in the gap, a share in the step between, [L, P]."""
        crossed = state.travel_since_reversal
        driving = state.force * state.velocity > 0.0
        loads = np.where(driving, self.lifting(state), np.inf)
        step = np.abs(state.velocity) * state.time_step[:, None]
        share = np.ones_like(crossed)
        for stroke in (state.velocity > 0.0, state.velocity < 0.0):
            lifted = np.min(np.where(stroke, loads, np.inf), axis=1)[:, None]
            ahead = (crossed - lifted - self.size) / np.maximum(step, 1e-12) + 0.5
            share = np.where(stroke & driving, np.clip(ahead, 0.0, 1.0), share)
        return share

    def lifting(self, state: BenchState) -> Grid:
        """Travel at which the force has come to pull with the motion, between two points, [L, P] m.

        At points at which it pulls; after the first of a stroke no less than there.
        """
        crossed, direction = state.travel_since_reversal, np.sign(state.velocity)
        same = direction == np.roll(direction, 1, axis=1)
        begin = np.where(same, np.roll(crossed, 1, axis=1), 0.0)
        before, after = direction * np.roll(state.force, 1, axis=1), direction * state.force
        part = np.where(before < 0.0, before / np.minimum(before - after, -1e-12), 0.0)
        return begin + np.clip(part, 0.0, 1.0) * (crossed - begin)
