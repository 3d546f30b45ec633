"""The physical RD-1005 over temperature, as BS09 tested it."""

from itertools import product
from typing import Final

from sysid.rig.physical.campaign import Asked, PhysicalCampaign
from sysid.rig.physical.rd1005 import RD_1005
from sysid.rig.physical.warming import Operator

EXCITATIONS: Final = ((10e-3, 8.0), (5e-3, 4.0), (20e-3, 4.0), (2.5e-3, 8.0))
"""m, Hz: BS09's two, and the same two speeds at the other frequency."""
TEMPERATURES: Final = (15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0)
"""°C."""
CURRENTS: Final = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
"""A."""

PHYSICAL_SWEEP: Final = PhysicalCampaign(
    id="physical-sweep",
    title="Physical RD-1005 damper, 15-75 °C",
    about=(
        "A short MR damper with the dimensions of an RD-1005, made of its physics: 15 to 75 °C in "
        "steps of 10 K, 0 to 1 A in steps of 0.2 A; 10 mm 8 Hz and 5 mm 4 Hz, as BS09 tested, and "
        "20 mm 4 Hz and 2.5 mm 8 Hz, the same speeds at the other frequency."
    ),
    limits="""\
stroke = { value = 53, unit = "mm" }       # of the damper, from end to end
velocity = { value = 1.0, unit = "m/s" }   # of BS09's actuator
current = { value = 1.0, unit = "A" }""",
    damper=RD_1005,
    settings=tuple(
        Asked(amplitude, frequency, current, temperature, labelled=True)
        for temperature, (amplitude, frequency), current in product(
            TEMPERATURES, EXCITATIONS, CURRENTS
        )
    ),
    seed=20090105,
    operator=Operator(power=45.0),
)
