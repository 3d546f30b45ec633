"""BS09's damper over temperature: Table 1, on the paper's two excitations and two more."""

from typing import Final

from sysid.rig.lumped_damper import CURRENTS, LumpedDamper
from sysid.rig.sweep import Sweep, warm_factorial

PAPER: Final = ((10e-3, 8.0), (5e-3, 4.0))
"""m, Hz: the excitations that BS09 identified its model on."""
SEPARATING: Final = ((20e-3, 4.0), (2.5e-3, 8.0))
"""m, Hz: the same two speeds at the other frequency."""
TEMPERATURES: Final = (
    11.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 55.0, 60.0, 65.0, 70.0, 75.0,
)  # fmt: skip
"""°C."""

VIRTUAL_BS09: Final = Sweep(
    id="virtual-bs09",
    title="Virtual BS09 damper, 11-75 °C",
    about=(
        "An MR damper that follows BS09's lumped model with the straight lines of its Table 1, "
        "swept over temperature: 11, 15, 20, … 75 °C; 0 to 1 A in steps of 0.2 A; 10 mm 8 Hz and "
        "5 mm 4 Hz, the excitations that the paper identified its model on. At 10 mm 8 Hz there is "
        "2 A too, where Table 1 gives a stiffness but no viscosity and no yield force: there the "
        "lines between 0.8 and 1 A go on, and the files end in `_extrapolated`. For validation, "
        "20 mm 4 Hz and 2.5 mm 8 Hz at 15 and 75 °C; 0, 0.4 and 1 A."
    ),
    damper=LumpedDamper(),
    settings=(
        *warm_factorial(PAPER, TEMPERATURES, CURRENTS),
        *warm_factorial(PAPER[:1], TEMPERATURES, (2.0,), "extrapolated"),
        *warm_factorial(SEPARATING, (15.0, 75.0), (0.0, 0.4, 1.0)),
    ),
    seed=20090101,
)
