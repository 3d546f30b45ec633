"""BS09's damper with what the paper saw and did not model: laws that depend on frequency."""

from typing import Final

from sysid.rig.lumped_damper import CURRENTS, FluidMemory, LumpedDamper
from sysid.rig.scenarios.virtual_bs09 import PAPER
from sysid.rig.sweep import Sweep, warm_factorial

TELLING: Final = ((10e-3, 2.0), (2.5e-3, 8.0))
"""m, Hz: the slower of the paper's two speeds at its larger amplitude, at its higher frequency."""

VIRTUAL_BS09_FREQUENCY: Final = Sweep(
    id="virtual-bs09-frequency",
    title="Virtual BS09 damper, 15-75 °C, with a hidden effect",
    about=(
        "An MR damper that follows BS09's lumped model, and one thing that the model does not "
        "have: the puzzle that the paper ends its validation with. 15, 45 and 75 °C; 0 to 1 A "
        "in steps of 0.2 A; 10 mm 8 Hz and 5 mm 4 Hz as in the paper, and 10 mm 2 Hz and 2.5 mm "
        "8 Hz, which have the speed of 5 mm 4 Hz at two other frequencies."
    ),
    damper=LumpedDamper(memory=FluidMemory(viscosity=0.05, yield_force=0.05, frequency=1.0)),
    settings=warm_factorial((*PAPER, *TELLING), (15.0, 45.0, 75.0), CURRENTS),
    seed=20090102,
)
