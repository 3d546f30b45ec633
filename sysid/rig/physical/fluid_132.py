"""The fluid of both dampers: Lord's MRF-132DG."""

from typing import Final

from sysid.rig.physical.oil import Oil

MRF_132: Final = Oil(
    solids=0.32,  # the 32 of its name
    consistency=0.2235,  # data sheet: 0.112 Pa·s at 40 °C and 800-1200 1/s, with the exponent below
    exponent=0.9,  # judged: thins a little
    slowest_shear=10.0,  # judged: where the structure no longer breaks
    activation=800.0,  # C_post of BS09 Table 1 falls by a third from 15 to 75 °C
    yield_loss=0.0037,  # F_y of BS09 Table 1 at 0.8 A, relative to its value at 15 °C
    density=3060.0,  # data sheet: 2.95-3.15 g/cm³
    bulk_modulus=1.5e9,  # mineral oil
    expansion=6e-4,  # the oil's 9e-4 by its two thirds of the volume, and a little of the iron
    air=0.01,  # entrained: 0.1-3 % in use
)
