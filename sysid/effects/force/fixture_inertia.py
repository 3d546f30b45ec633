"""Inertia of the fixture between load cell and damper."""

from typing import ClassVar

from sysid.arrays import Scalar
from sysid.effects.base import AbstractForceEffect, Facts, Force
from sysid.motion.motion import Motion
from sysid.parameters import param


class FixtureInertia(AbstractForceEffect):
    r"""What moves with the rod on the damper's side of the load cell.

        F = m_x a

    Source:
        Adapters and rod ends, 0.3–2 kg.  Negative where a load cell that compensates for them does
        so by too much.
    """

    facts: ClassVar[Facts] = Facts(
        id="fixture_inertia",
        family="reactive",
        found_from="loops",
        size="m_x",
        nominal={"m_x": 1.0},
        realistic={"m_x": (-2.0, 2.0)},
        parity=("OC", 1.0),
        exponents=(1.0, 2.0, 0.0),
        rivals=("fluid_inertia", "gas_spring", "force_delay"),
        separating_test="run the rig with the damper removed",
        source="adapters and rod ends",
    )
    m_x: Scalar = param(symbol="m_x", name="mass of the fixture", unit="kg", typical=1.0)

    def force(self, motion: Motion) -> Force:
        """Force of inertia."""
        return self.m_x * motion.acceleration
