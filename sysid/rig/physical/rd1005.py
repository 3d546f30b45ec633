"""A short damper with a diaphragm accumulator, as BS09 tested: dimensions of Lord's RD-1005."""

from math import pi
from typing import Final

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

BORE: Final = 38e-3
"""m; Spencer 1997: main cylinder of 3.8 cm."""
ROD: Final = 10e-3
"""m; data sheet."""

RD_1005: Final = PhysicalDamper(
    cylinder=Cylinder(
        bore=0.25 * pi * BORE**2,
        rod=0.25 * pi * ROD**2,
        far=34e-6,  # half the stroke of 53 mm (data sheet) and 4 ml that the piston never sweeps
        near=32e-6,  # the same beside the rod
        mass=0.35,  # judged: of 0.8 kg in all (data sheet)
    ),
    oil=MRF_132,
    valve=Valve(
        gap=0.75e-3,  # judged: within the 0.5-1 mm of built valves
        width=pi * 30e-3,  # judged: bobbin inside a flux ring inside the bore
        active=12.3e-3,  # so that the yield force at 1 A is BS09's (1.57 kN at 15 °C)
        passive=21.7e-3,  # so that the off-state slope is BS09's (1.3 kN·s/m at 15 °C)
        entrance=1.5,  # sharp entrance 0.5 and exit 1
        creep=1.1e-11,  # (A_p − A_r)²/C_pre with BS09's C_pre = 100 kN·s/m
    ),
    magnet=Magnet(
        turns=330.0,  # judged: BS09's yield force at 1 A, two thirds of it at 0.6 A
        iron=60e-3,  # judged from the size of the piston
        narrowing=2.0,  # judged: core of 20 mm, poles of 7 mm
        saturation=2.0,  # low-carbon steel
        permeability=1000.0,  # low-carbon steel
        coercive=150.0,  # low-carbon steel, not annealed
        loop_width=0.05,  # judged: small against the range of 0.7 T
        resistance=5.0,  # data sheet, at ambient temperature
        inductance=0.1,  # N times flux over current
        amplifier=28.0,  # so that the lag is BS09's 3 ms
    ),
    gas=Accumulator(
        charge=2.7e6,  # judged: Spencer 1997 has 300 psi (gauge) with the rod out, 2.2 MPa
        volume=16e-6,  # judged: eight times what the rod displaces to its stop
        heat_time=0.5,  # judged: a layer of gas of some millimetres
    ),
    floating=Seal(
        sliding=8.0,  # a diaphragm flexes and hardly rubs
        breakaway=8.0,
        per_pressure=0.0,
        stribeck_speed=5e-3,
        stiffness=2e5,
        damping=50.0,
        viscous=300.0,  # judged
    ),
    seal=Seal(
        sliding=20.0,  # with the pressure's share and remanence BS09's F_y at 0 A, 40 N
        breakaway=28.0,  # judged: 4 parts in 10 more
        per_pressure=5e-6,  # judged: BS09 sees friction rise with the accumulator's pressure
        stribeck_speed=5e-3,  # order of 1-20 mm/s of lip seals
        stiffness=5e5,  # Canudas de Wit 1995 uses 1e5; a stiffer lip
        damping=316.0,  # Canudas de Wit 1995
        viscous=40.0,  # judged
    ),
    mixing=Mixing(
        saturation=0.6e6,  # judged
        release=0.05,  # judged: some foam in the fastest tests at 15 °C
        dissolving=0.8,  # judged
        most=0.03,  # judged
    ),
    heat=HeatBalance(
        oil=260.0,  # judged: 66 ml of 3.06 kg/l, 0.8 J/g/K (data sheet), most of a 0.25 kg piston
        body=250.0,  # the rest of 0.8 kg of steel, 0.5 J/g/K
        inner=15.0,  # judged: 100 cm² of moved oil at 1500 W/m²/K
        outer=0.6,  # 300 cm² at 10 W/m²/K in still air, and as much through the clevises
        room=22.0,
        thermocouple=1.5,  # judged: insulated from the tubing, on the body (BS09)
    ),
    rig=Rig(
        servo=2.0 * pi * 25.0,  # judged
        column=6.8e7,  # 4 β A/stroke of BS09's ±25 kN, ±50 mm at 20.7 MPa
        mount=2e7,  # judged: two clevises and a load cell
        play=20e-6,  # judged: running fit of a pin
        restitution=0.5,  # judged: a tenth of critical at 1 kN
    ),
    wear=Wear(seal=1e-4, gas=0.0, creep=1e-4),  # judged: 10 % a kilometre; a diaphragm keeps gas
)
"""Data sheet: Lord Corporation, RD-1005-3 MR damper.  Spencer 1997: Spencer, Dyke, Sain, Carlson,
Phenomenological model for magnetorheological dampers, J. Eng. Mech. 123 (1997) 230–238."""
