"""The whole damper: every constant, by part."""

import equinox as eqx

from sysid.rig.physical.constant import Constant
from sysid.rig.physical.friction import Seal
from sysid.rig.physical.gas import Accumulator
from sysid.rig.physical.heat import HeatBalance
from sysid.rig.physical.magnet import Magnet
from sysid.rig.physical.mixing import Mixing
from sysid.rig.physical.oil import Oil
from sysid.rig.physical.rig import Rig
from sysid.rig.physical.valve import Valve
from sysid.rig.physical.wear import Wear


class Cylinder(eqx.Module):
    """Dimensions at mid-stroke and 20 °C.

    Attributes:
        bore: Area of the piston, m².
        rod: Area of the rod, m².
        far: Volume of oil on the side without rod, which compression makes smaller, m³.
        near: The same on the rod's side, m³.
        mass: Of rod and piston, kg.
    """

    bore: Constant
    rod: Constant
    far: Constant
    near: Constant
    mass: Constant


class PhysicalDamper(eqx.Module):
    """A monotube damper in its rig; `equations` says how the parts act on each other."""

    cylinder: Cylinder
    oil: Oil
    valve: Valve
    magnet: Magnet
    gas: Accumulator
    floating: Seal
    seal: Seal
    mixing: Mixing
    heat: HeatBalance
    rig: Rig
    wear: Wear
