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
        near=170e-6,  # the same beside the rod
        mass=1.0,  # judged: rod of 0.3 m, piston with coil
    ),
    oil=eqx.tree_at(lambda oil: oil.air, MRF_132, 0.03),  # judged: as much as is met in use
    valve=Valve(
        gap=0.8e-3,  # judged: within the 0.5-1 mm of built valves
        width=pi * 37e-3,  # judged: bobbin inside a flux ring inside the bore
        active=6.6e-3,  # so that the force at 0.4 A is W11's (1.2-1.6 kN)
        passive=28.4e-3,  # so that the off-state slope is W11's (1.2 kN·s/m)
        entrance=0.7,  # rounded entrance, diffusing exit
        creep=2.2e-11,  # (A_p − A_r)²/C_pre with BS09's C_pre = 100 kN·s/m
    ),
    magnet=Magnet(
        turns=1500.0,  # judged: W11's rise of force over 0-0.4 A, thin wire for 12 V and 0.5 A
        iron=70e-3,  # judged from the size of the piston
        narrowing=1.9,  # judged: saturates near the limit of 0.5 A (W11)
        saturation=1.6,  # free-cutting steel
        permeability=1000.0,  # free-cutting steel
        coercive=150.0,  # the same, not annealed
        loop_width=0.05,  # judged: small against the range of 0.8 T
        resistance=20.0,  # below 12 V over 0.5 A (W11)
        inductance=1.0,  # N times flux over current, near saturation
        amplifier=180.0,  # lag of 5 ms: a voltage-to-current circuit (W11)
    ),
    gas=Accumulator(
        charge=2.3e6,  # judged: 20-25 bar are common in monotubes
        volume=60e-6,  # judged: the rod takes 11 ml to its stop
        heat_time=1.0,  # judged: a layer of gas of a centimetre
    ),
    floating=Seal(
        sliding=60.0,  # judged: a ring of 45 mm
        breakaway=60.0,
        per_pressure=0.0,
        stribeck_speed=5e-3,
        stiffness=1e6,  # judged: gives by 60 µm
        damping=300.0,  # Canudas de Wit 1995 has 316
        viscous=300.0,  # judged
    ),
    seal=Seal(
        sliding=50.0,  # with the pressure's share W11's force at slow speed and 0 A, 2 F_0 ≈ 140 N
        breakaway=65.0,  # judged: 3 parts in 10 more
        per_pressure=1e-5,  # judged: a lip under 1 MPa presses 10 N harder
        stribeck_speed=5e-3,  # order of 1-20 mm/s of lip seals
        stiffness=1e6,  # judged: gives by 60 µm
        damping=300.0,  # Canudas de Wit 1995 has 316
        viscous=60.0,  # judged
    ),
    mixing=Mixing(
        saturation=1.9e6,  # so that it begins where W11 saw it, at 0.3 A and 10 Hz
        release=1.5,  # so that it is seen there
        dissolving=1.0,  # judged
        most=0.05,  # judged: as much as free air
    ),
    heat=HeatBalance(
        oil=1090.0,  # 350 ml of 3.06 kg/l and 0.8 J/g/K (fluid data sheet), piston 0.5 kg of steel
        body=960.0,  # 2 kg of steel
        inner=25.0,  # judged: 300 cm² of moved oil at some 800 W/m²/K
        outer=1.2,  # 550 cm² at 10 W/m²/K in still air, and as much through the clevises
        room=22.0,
        thermocouple=2.0,  # judged: taped to the body
    ),
    rig=Rig(
        servo=2.0 * pi * 25.0,  # judged
        column=3.4e7,  # as of BS09's actuator, with twice the stroke
        mount=1e7,  # judged: two clevises, rubber-free, and a load cell
        play=20e-6,  # judged: running fit of a pin
        restitution=0.5,  # judged: a tenth of critical at 1 kN
    ),
    wear=Wear(seal=1e-4, gas=1e-5, creep=1e-4),  # judged: 10, 1 and 10 % a kilometre
)
