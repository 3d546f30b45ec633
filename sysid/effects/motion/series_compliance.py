"""Mount or fluid column in series with the valve."""

from collections.abc import Callable
from typing import ClassVar, Final, TypeAlias

from sysid.arrays import Scalar
from sysid.effects.backward_differences import differences_of
from sysid.effects.base import AbstractMotionEffect, Behind, Facts, Force
from sysid.effects.fourier import refined
from sysid.effects.series_spring import Setting, series_force
from sysid.motion.motion import Motion
from sysid.parameters import param

FINEST: Final = 216
"""Points of a cycle at least, for the time integration; coarser cycles are refined.

Against 2880 points the force of a valve is off by 0.3 % of its largest at the worst instant and
by 0.06 % rms.
"""


class SeriesCompliance(AbstractMotionEffect):
    r"""A spring between the recorded motion and everything behind it.

        x_v = x − s_k F,   v_v = v − s_k Ḟ,   a_v = a − s_k F̈,   F = Φ(x_v, v_v, a_v)

    On a cycle the periodic solution is found on at least 216 points with third-order backward
    differences; elsewhere the spring starts relaxed and second-order differences follow the
    grid.  The place x_v, to which stiff dampers without play are indifferent, is that of a first
    solution with x_v = x; travel since a reversal is thus that of the valve, not of the rod, and
    each solution is pointwise in time.  Sign of acceleration and peak velocity stay those of
    the recorded motion.

    A valve that takes changes into its own equations (`AbstractInnerValve`: the lumped model, Dahl,
    both Bouc–Wen models) takes this spring instead (`Damper`), within 0.2 % of the largest force
    at the worst instant; with friction beside it, within 0.4 %.

    Source:
        BS09 Eq. 1 (spring of the lumped model, 3.7–12.7 MN/m); mounts 2–40 MN/m.
    """

    facts: ClassVar[Facts] = Facts(
        id="series_compliance",
        family="timing",
        found_from="loops",
        size="s_k",
        nominal={"s_k": 1.0e-7},
        realistic={"s_k": (2.5e-8, 5.0e-7)},
        parity=("OC", 0.55),
        exponents=(0.0, 0.9, 0.79),
        rivals=("force_delay", "force_filter", "backlash"),
        separating_test=(
            "change the current at one amplitude and frequency: the lag in displacement grows in "
            "proportion to the force, a delay does not"
        ),
        source="BS09 Eq. 1 and Table 1",
    )
    s_k: Scalar = param(
        symbol="s_k", name="compliance in series", unit="m/N", low=0.0, typical=1.0e-7
    )

    def at_valve(self, motion: Motion, force: Callable[[Motion], Force]) -> Motion:
        """Motion behind the spring."""
        points = motion.displacement.shape[-1]
        times = -(-FINEST // points) if motion.periodic else 1
        fine = refined(motion, times) if motion.periodic else motion
        setting = Setting(
            fine.displacement, fine.velocity, fine.acceleration, self.s_k, differences_of(fine),
            motion.periodic,
        )  # fmt: skip

        def behind(x: Force, w: Force, a: Force) -> tuple[Force, Force]:
            moved = fine.moved(x, w, a)
            return force.within(moved) if isinstance(force, Behind) else (w, force(moved))

        place, carried = series_force(behind, setting)
        rate, curvature = setting.differences.rate(carried), setting.differences.curvature(carried)
        inner = (
            motion.displacement + (place - fine.displacement)[..., ::times],
            motion.velocity - self.s_k * rate[..., ::times],
            motion.acceleration - self.s_k * curvature[..., ::times],
        )
        return motion.moved(*inner)


Change: TypeAlias = tuple[Force, Force, Force]
"""Of displacement, velocity and acceleration, m, m/s, m/s²."""


def change_behind(motion: Motion, compliance: Scalar, force: Force) -> Change:
    """What a spring that carries a force takes from the motion ahead of it.

    Args:
        motion: Ahead of the spring.
        compliance: m/N.
        force: That it carries, N.
    """
    differences = differences_of(motion)
    rate, curvature = differences.rate(force), differences.curvature(force)
    return -compliance * force, -compliance * rate, -compliance * curvature


def moved_by(motion: Motion, change: Change) -> Motion:
    """The motion with a change."""
    x, v, a = change
    return motion.moved(motion.displacement + x, motion.velocity + v, motion.acceleration + a)
