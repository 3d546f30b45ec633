"""What a damper loses with the way that its piston has gone."""

import equinox as eqx

from sysid.rig.physical.constant import Constant


class Wear(eqx.Module):
    """Wear in proportion to sliding distance (Archard), as shares lost for each metre.

    Attributes:
        seal: Of the rod seal's friction, 1/m.
        gas: Of the gas, past the floating piston, 1/m.
        creep: Growth of the flow past the valve before it yields, 1/m.

    Source:
        Archard, Contact and rubbing of flat surfaces, J. Appl. Phys. 24 (1953) 981–988.
    """

    seal: Constant
    gas: Constant
    creep: Constant
