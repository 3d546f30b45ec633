"""W11's damper from 5 Hz up: the symmetric set of Table 2 for 5–15 Hz on the 2.5 mm tests."""

from typing import Final

from sysid.models.generalized import HIGH_SYMMETRIC
from sysid.rig.scenario import Scenario, full_factorial

VIRTUAL_W11_HIGH: Final = Scenario(
    id="virtual-w11-high",
    title="Virtual W11 damper, 5-15 Hz",
    about=(
        "A symmetric MR damper that follows W11's generalised model with the 5-15 Hz set of its "
        "Table 2, on the tests that set was fitted on: 2.5 mm; 5, 7.5, 10, 12.5 and 15 Hz; 0 to "
        "0.4 A in steps of 0.1 A."
    ),
    parameters=HIGH_SYMMETRIC,
    settings=full_factorial((2.5e-3,), (5.0, 7.5, 10.0, 12.5, 15.0), (0.0, 0.1, 0.2, 0.3, 0.4)),
    seed=20110502,
)
