"""The scenarios on the physical damper; apart, since they need JAX."""

from typing import Final

from sysid.rig.physical.campaign import PhysicalCampaign
from sysid.rig.scenarios.physical_matrix_165 import PHYSICAL_MATRIX_165
from sysid.rig.scenarios.physical_sweep import PHYSICAL_SWEEP

PHYSICAL: Final[tuple[PhysicalCampaign, ...]] = (PHYSICAL_MATRIX_165, PHYSICAL_SWEEP)
