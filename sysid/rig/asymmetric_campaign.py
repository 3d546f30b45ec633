"""A campaign whose current follows the direction of motion."""

from dataclasses import dataclass

from sysid.rig.asymmetric_drive import AsymmetricDrive
from sysid.rig.bench import Setting
from sysid.rig.scenario import Scenario


@dataclass(frozen=True)
class AsymmetricCampaign:
    """A virtual campaign behind W11's asymmetric current.

    Attributes:
        design: Damper, tests, rig; its currents are those commanded, which is what is recorded.
        drive: What makes the coil's current of them.
    """

    design: Scenario
    drive: AsymmetricDrive

    @property
    def id(self) -> str:
        """Name on the command line, and of the dataset's folder."""
        return self.design.id

    @property
    def title(self) -> str:
        """Name of the campaign."""
        return self.design.title

    @property
    def settings(self) -> tuple[Setting, ...]:
        """The tests."""
        return self.design.settings

    @property
    def seed(self) -> int:
        """Of the random numbers."""
        return self.design.seed
