"""The scenarios that `sysid rig` knows, one a file."""

from typing import TYPE_CHECKING, Final

from sysid.errors import DataError
from sysid.rig.asymmetric_campaign import AsymmetricCampaign
from sysid.rig.scenario import Scenario
from sysid.rig.scenarios.virtual_asymmetric import VIRTUAL_ASYMMETRIC
from sysid.rig.scenarios.virtual_bs09 import VIRTUAL_BS09
from sysid.rig.scenarios.virtual_bs09_frequency import VIRTUAL_BS09_FREQUENCY
from sysid.rig.scenarios.virtual_bs09_heating import VIRTUAL_BS09_HEATING
from sysid.rig.scenarios.virtual_w11_asymmetric import VIRTUAL_W11_ASYMMETRIC
from sysid.rig.scenarios.virtual_w11_high import VIRTUAL_W11_HIGH
from sysid.rig.scenarios.virtual_w11_low import VIRTUAL_W11_LOW
from sysid.rig.sweep import Sweep

if TYPE_CHECKING:
    from sysid.rig.physical.campaign import PhysicalCampaign

SCENARIOS: Final[tuple[Scenario | Sweep | AsymmetricCampaign, ...]] = (
    VIRTUAL_W11_LOW,
    VIRTUAL_W11_HIGH,
    VIRTUAL_W11_ASYMMETRIC,
    VIRTUAL_ASYMMETRIC,
    VIRTUAL_BS09,
    VIRTUAL_BS09_FREQUENCY,
    VIRTUAL_BS09_HEATING,
)


def find_scenario(name: str) -> "Scenario | Sweep | AsymmetricCampaign | PhysicalCampaign":
    """The scenario of an id.

    Raises:
        DataError: No scenario has it.
    """
    for scenario in SCENARIOS:
        if scenario.id == name:
            return scenario
    from sysid.rig.scenarios.physical import PHYSICAL

    for campaign in PHYSICAL:
        if campaign.id == name:
            return campaign
    known = ", ".join(scenario.id for scenario in (*SCENARIOS, *PHYSICAL))
    raise DataError(f"there is no scenario {name!r}", advice=f"Scenarios: {known}")
