"""All 165 tests of W11's Table 1 on the physical automotive damper."""

from itertools import product
from typing import Final

from sysid.rig.physical.automotive import AUTOMOTIVE
from sysid.rig.physical.campaign import Asked, PhysicalCampaign
from sysid.rig.physical.warming import Operator
from sysid.rig.trial_matrix import CONDITIONS, CURRENTS

PHYSICAL_MATRIX_165: Final = PhysicalCampaign(
    id="physical-matrix-165",
    title="Physical automotive damper, W11 test matrix",
    about=(
        "An automotive MR damper of 200 mm stroke, made of its physics, in all 165 tests of W11's "
        "Table 1: 2.5 to 75 mm, 0.1 to 15 Hz, 0 to 0.4 A, with the body at 40 °C. In the fastest "
        "tests the oil cavitates."
    ),
    limits="""\
stroke = { value = 200, unit = "mm" }      # of the damper, from end to end
velocity = { value = 1.6, unit = "m/s" }   # fastest test of W11's Table 1: 50 mm, 5 Hz
current = { value = 0.5, unit = "A" }""",
    damper=AUTOMOTIVE,
    settings=tuple(
        Asked(amplitude, frequency, current, 40.0)
        for amplitude, frequencies in CONDITIONS
        for frequency, current in product(frequencies, CURRENTS)
    ),
    seed=20110101,
    operator=Operator(power=95.0, coolant=22.0, cooling=3.0, scatter=2.5, window=10.0),
)
