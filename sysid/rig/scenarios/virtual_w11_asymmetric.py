"""W11's damper with its asymmetric current drive: the set of Table 3 on its 16 tests."""

from typing import Final

from sysid.models.generalized import ASYMMETRIC
from sysid.rig.scenario import Scenario, full_factorial

VIRTUAL_W11_ASYMMETRIC: Final = Scenario(
    id="virtual-w11-asymmetric",
    title="Virtual W11 damper, asymmetric",
    about=(
        "An MR damper with asymmetric damping that follows W11's generalised model with the set "
        "of its Table 3, on the tests that set was fitted on: 12.5 and 25 mm; 0.5 and 1.5 Hz; 0 "
        "to 0.3 A in steps of 0.1 A. As the published set does, it keeps a force at zero velocity "
        "and at rest."
    ),
    parameters=ASYMMETRIC,
    settings=full_factorial((12.5e-3, 25e-3), (0.5, 1.5), (0.0, 0.1, 0.2, 0.3)),
    seed=20110503,
)
