"""A damper of 200 mm stroke for a car, as W11 tested: monotube with floating piston."""

from math import pi
from typing import Final

import equinox as eqx

from sysid.rig.physical.damper import Cylinder, PhysicalDamper
from sysid.rig.physical.fluid_132 import MRF_132
from sysid.rig.physical.friction import Seal
from sysid.rig.physical.gas import Accumulator
from sysid.rig.physical.heat import HeatBalance
from sysid.rig.physical.magnet import Magnet
from sysid.rig.physical.mixing import Mixing
from sysid.rig.physical.rig import Rig
from sysid.rig.physical.valve import Valve
from sysid.rig.physical.wear import Wear

BORE: Final = 45e-3
"""m; judged: common in cars and racing."""
ROD: Final = 12e-3
"""m; judged."""

AUTOMOTIVE: Final = PhysicalDamper(
    cylinder=Cylinder(
        bore=0.25 * pi * BORE**2,
        rod=0.25 * pi * ROD**2,
        far=180e-6,  # half of 200 mm (W11) and 15 mm that the piston never sweeps
        near=170e-6,
        mass=1.0,
    ),
    oil=eqx.tree_at(lambda oil: oil.air, MRF_132, 0.03),
    valve=Valve(
        gap=0.8e-3,
        width=pi * 37e-3,
        active=6.6e-3,
        passive=28.4e-3,
        entrance=0.7,
        creep=2.2e-11,
    ),
    magnet=Magnet(
        turns=1500.0,
        iron=70e-3,
        narrowing=1.9,
        saturation=1.6,
        permeability=1000.0,
        coercive=150.0,
        loop_width=0.05,
        resistance=20.0,
        inductance=1.0,
        amplifier=180.0,
    ),
    gas=Accumulator(charge=2.3e6, volume=60e-6, heat_time=1.0),
    floating=Seal(
        sliding=60.0, breakaway=60.0, per_pressure=0.0, stribeck_speed=5e-3,
        stiffness=1e6, damping=300.0, viscous=300.0,
    ),
    seal=Seal(
        sliding=50.0, breakaway=65.0, per_pressure=1e-5, stribeck_speed=5e-3,
        stiffness=1e6, damping=300.0, viscous=60.0,
    ),
    mixing=Mixing(saturation=1.9e6, release=1.5, dissolving=1.0, most=0.05),
    heat=HeatBalance(
        oil=1090.0, body=960.0, inner=25.0, outer=1.2, room=22.0, thermocouple=2.0
    ),
    rig=Rig(servo=2.0 * pi * 25.0, column=3.4e7, mount=1e7, play=20e-6, restitution=0.5),
    wear=Wear(seal=1e-4, gas=1e-5, creep=1e-4),
)  # fmt: skip
