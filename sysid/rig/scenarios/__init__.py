"""The scenarios that `sysid rig` knows, one a file."""

from typing import Final

from sysid.errors import DataError
from sysid.rig.scenario import Scenario
from sysid.rig.scenarios.virtual_w11_asymmetric import VIRTUAL_W11_ASYMMETRIC
from sysid.rig.scenarios.virtual_w11_high import VIRTUAL_W11_HIGH
from sysid.rig.scenarios.virtual_w11_low import VIRTUAL_W11_LOW

SCENARIOS: Final[tuple[Scenario, ...]] = (
    VIRTUAL_W11_LOW,
    VIRTUAL_W11_HIGH,
    VIRTUAL_W11_ASYMMETRIC,
)


def find_scenario(name: str) -> Scenario:
    """The scenario of an id.

    Raises:
        DataError: No scenario has it.
    """
    for scenario in SCENARIOS:
        if scenario.id == name:
            return scenario
    known = ", ".join(scenario.id for scenario in SCENARIOS)
    raise DataError(f"there is no scenario {name!r}", advice=f"Scenarios: {known}")
