"""What damper people read off a loop: peaks, energy, width, knee, asymmetry, gas force."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from sysid.data.knee import Branches, branches, find_knees, zero_crossing
from sysid.data.loops import Loops, PerLoop

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Descriptors:
    """One number a loop each, [L]; NaN where a loop has no such thing.

    Attributes:
        ids: L ids.
        peak_compression: max F, N.
        peak_rebound: −min F, N.
        asymmetry: γ = peak_rebound / peak_compression (W11: rebound over compression).
        energy: ∮F dx per cycle, J.
        equivalent_damping: E/(π ω A²), N·s/m.
        effective_stiffness: Part of the force's fundamental in phase with the displacement, over
            A, N/m.
        gas_force: Mean over the cycle, N; an asymmetry of the damping is in it too.
        reversal_force: Mean of the forces at the two reversals (v = 0), N: the gas force too, but
            free of asymmetry at speed, and sensitive to what happens at reversal.
        force_width: Force at the end of compression minus force at the end of rebound, both at
            v = 0, N: the width of the f–v loop at zero velocity.
        velocity_intercept: Half the distance between the velocities at which the force is zero
            on the accelerating and on the decelerating branch, m/s; positive where force lags
            velocity (v_h of W11).
        velocity_width: The whole distance, m/s.
        velocity_offset: Minus the middle of the two, m/s (v_b of W11).
        knee_velocity: Transition velocity, m/s: where the low-velocity secant meets the
            post-yield line (see `knee`).
        yield_force: Zero-velocity intercept of the post-yield line, N.
        pre_yield_damping: Slope of the low-velocity secant, N·s/m.
        post_yield_damping: Slope of the post-yield line, N·s/m.
        yield_share: Yield force over the force at the line's end: 1 for dry friction, 0 for a
            linear damper, whose f–v curve has no knee.
    """

    ids: tuple[str, ...]
    peak_compression: PerLoop
    peak_rebound: PerLoop
    asymmetry: PerLoop
    energy: PerLoop
    equivalent_damping: PerLoop
    effective_stiffness: PerLoop
    gas_force: PerLoop
    reversal_force: PerLoop
    force_width: PerLoop
    velocity_intercept: PerLoop
    velocity_width: PerLoop
    velocity_offset: PerLoop
    knee_velocity: PerLoop
    yield_force: PerLoop
    pre_yield_damping: PerLoop
    post_yield_damping: PerLoop
    yield_share: PerLoop

    def to_frame(self) -> "pd.DataFrame":
        """One row a loop, indexed by id, units in the column names."""
        import pandas as pd

        columns = {f"{name}{unit}": getattr(self, name) for name, unit in _UNITS.items()}
        return pd.DataFrame(columns, index=pd.Index(self.ids, name="id"))


_UNITS = {
    "peak_compression": "_N",
    "peak_rebound": "_N",
    "asymmetry": "",
    "energy": "_J",
    "equivalent_damping": "_N*s/m",
    "effective_stiffness": "_N/m",
    "gas_force": "_N",
    "reversal_force": "_N",
    "force_width": "_N",
    "velocity_intercept": "_m/s",
    "velocity_width": "_m/s",
    "velocity_offset": "_m/s",
    "knee_velocity": "_m/s",
    "yield_force": "_N",
    "pre_yield_damping": "_N*s/m",
    "post_yield_damping": "_N*s/m",
    "yield_share": "",
}


def describe(loops: Loops) -> Descriptors:
    """Read the descriptors off every loop at once."""
    force, omega = loops.force, 2.0 * np.pi * loops.frequency
    points = force.shape[1]
    phase = 2.0 * np.pi * np.arange(points) / points
    energy = np.mean(force * loops.velocity, axis=1) / loops.frequency
    sides = branches(force)
    end_of_compression, end_of_rebound = sides.falling_at(0.0), sides.rising_at(0.0)
    low, high = _intercepts(sides, loops)
    knee = find_knees(sides, loops.peak_velocity)
    compression, rebound = force.max(axis=1), -force.min(axis=1)
    return Descriptors(
        ids=loops.ids,
        peak_compression=compression,
        peak_rebound=rebound,
        asymmetry=np.divide(
            rebound, compression, out=np.full_like(rebound, np.nan), where=compression != 0.0
        ),
        energy=energy,
        equivalent_damping=energy / (np.pi * omega * loops.amplitude**2),
        effective_stiffness=2.0 * np.mean(force * np.sin(phase), axis=1) / loops.amplitude,
        gas_force=force.mean(axis=1),
        reversal_force=0.5 * (end_of_compression + end_of_rebound),
        force_width=end_of_compression - end_of_rebound,
        velocity_intercept=0.5 * (high - low),
        velocity_width=high - low,
        velocity_offset=-0.5 * (high + low),
        knee_velocity=knee.velocity,
        yield_force=knee.yield_force,
        pre_yield_damping=knee.pre_yield_damping,
        post_yield_damping=knee.post_yield_damping,
        yield_share=knee.yield_share,
    )


def _intercepts(
    sides: Branches, loops: Loops
) -> tuple[Float[np.ndarray, " loop"], Float[np.ndarray, " loop"]]:
    """Velocity at zero force on the falling and on the rising branch, m/s."""
    speed = loops.peak_velocity
    return speed * zero_crossing(sides.falling), speed * zero_crossing(sides.rising)
