"""W11's symmetric damper made asymmetric by its current, with a coil that is late."""

from typing import Final

from sysid.models.generalized import LOW_SYMMETRIC
from sysid.rig.asymmetric_campaign import AsymmetricCampaign
from sysid.rig.asymmetric_drive import AsymmetricDrive
from sysid.rig.scenario import Scenario, full_factorial

VIRTUAL_ASYMMETRIC: Final = AsymmetricCampaign(
    design=Scenario(
        id="virtual-asymmetric",
        title="Virtual W11 damper, asymmetric by its current",
        about=(
            "A symmetric MR damper that follows W11's generalised model with the 0.5-5 Hz set of "
            "its Table 2, behind W11's asymmetric current (Eqs. 1 and 2, p = 0, ζ = 2): the "
            "controller asks for more of the commanded current in rebound and for less in "
            "compression, and the coil follows late. The current in the files is the commanded "
            "one. On the tests of W11's asymmetric set: 12.5 and 25 mm; 0.5 and 1.5 Hz; 0 to "
            "0.3 A in steps of 0.1 A. At 0 A there is no current to modulate, and the damper is "
            "symmetric."
        ),
        parameters=LOW_SYMMETRIC,
        settings=full_factorial((12.5e-3, 25e-3), (0.5, 1.5), (0.0, 0.1, 0.2, 0.3)),
        seed=20110504,
    ),
    drive=AsymmetricDrive(compression=0.0, smoothing=2.0, lag=0.003),
)
