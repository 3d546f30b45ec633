"""W11's damper below 5 Hz: the symmetric set of Table 2 for 0.5–5 Hz on the 12.5 mm tests."""

from typing import Final

from sysid.models.generalized import LOW_SYMMETRIC
from sysid.rig.scenario import Scenario, full_factorial

VIRTUAL_W11_LOW: Final = Scenario(
    id="virtual-w11-low",
    title="Virtual W11 damper, 0.5-5 Hz",
    about=(
        "A symmetric MR damper that follows W11's generalised model with the 0.5-5 Hz set of its "
        "Table 2, on the tests that set was fitted on: 12.5 mm; 0.5, 1.5, 2.5 and 5 Hz; 0 to "
        "0.4 A in steps of 0.1 A."
    ),
    parameters=LOW_SYMMETRIC,
    settings=full_factorial((12.5e-3,), (0.5, 1.5, 2.5, 5.0), (0.0, 0.1, 0.2, 0.3, 0.4)),
    seed=20110501,
)
