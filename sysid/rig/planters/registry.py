"""All planters, as they come from the factory; scale them with `dataclasses.replace`."""

from typing import Final

from sysid.errors import DataError
from sysid.rig.planters.backlash import LoosePin, RodPlay
from sysid.rig.planters.bump_stop import RubberStop
from sysid.rig.planters.fluid_inertia import OilColumn
from sysid.rig.planters.fluid_law import RelaxingChains, VogelOil, WarmParticles
from sysid.rig.planters.force_channel import (
    BentLoadCell,
    ButterworthChannel,
    ConverterLimit,
    LateSampling,
    WrongCalibration,
)
from sysid.rig.planters.force_offset import GasPreload
from sysid.rig.planters.gas_chamber import BalancedGasChamber, GasChamber, LargeGasChamber
from sysid.rig.planters.gas_pocket import GasPocket
from sysid.rig.planters.gas_temperature import WarmGas
from sysid.rig.planters.history import BodyThermometer, HeatedOil, SettledParticles, WornGap
from sysid.rig.planters.magnet import EddyCurrents, MagnetizedCore, Remanence, SaturatedCore
from sysid.rig.planters.oil_flow import LeakingPiston, OilFilm, Orifice, ShearThinningGap
from sysid.rig.planters.outside_oil import (
    CheckValve,
    CollapsingBubble,
    OneSidedLip,
    ShimStack,
    StickingPiston,
    ThixotropicOil,
)
from sysid.rig.planters.outside_rig import RingingFixture, RubberBush, SlippingClamp
from sysid.rig.planters.outside_wall import FadingMagnet, ScratchedWall
from sysid.rig.planters.planter import Planter
from sysid.rig.planters.rod_friction import BreakawaySeal, SideLoad, SoftSeal, StiffSeal
from sysid.rig.planters.soft_mount import SoftMount

CATALOGUE: Final[tuple[Planter, ...]] = (
    GasPreload(), LargeGasChamber(), BalancedGasChamber(), WarmGas(), OilColumn(),
    LateSampling(), ButterworthChannel(),
    StiffSeal(), BreakawaySeal(), SoftSeal(), SideLoad(),
    SoftMount(), RodPlay(), LoosePin(), GasPocket(),
    ShearThinningGap(), Orifice(), OilFilm(), LeakingPiston(),
    RelaxingChains(), VogelOil(), WarmParticles(), EddyCurrents(),
    RubberStop(), BentLoadCell(), ConverterLimit(),
)  # fmt: skip
"""One effect each that steady loops can show."""

HISTORY: Final[tuple[Planter, ...]] = (
    HeatedOil(), Remanence(), SettledParticles(), WornGap(), BodyThermometer(),
)  # fmt: skip
"""Effects of the catalogue that need the run order or the cycles."""

INVISIBLE: Final[tuple[Planter, ...]] = (WrongCalibration(), MagnetizedCore(), SaturatedCore())
"""Effects of the catalogue that the damper's own parameters absorb at constant current."""

COMPOUND: Final[tuple[Planter, ...]] = (GasChamber(),)
"""Parts of a real damper that plant two effects of the catalogue at once."""

OUTSIDE: Final[tuple[Planter, ...]] = (
    RingingFixture(), SlippingClamp(), RubberBush(), ThixotropicOil(), CollapsingBubble(),
    CheckValve(), ShimStack(), StickingPiston(), OneSidedLip(), ScratchedWall(), FadingMagnet(),
)  # fmt: skip
"""Effects that are not in the catalogue, each with its family declared here, or none."""

PLANTERS: Final[tuple[Planter, ...]] = CATALOGUE + HISTORY + INVISIBLE + COMPOUND + OUTSIDE


def find_planter(name: str) -> Planter:
    """The planter of a name.

    Raises:
        DataError: There is none.
    """
    for planter in PLANTERS:
        if planter.name == name:
            return planter
    known = ", ".join(planter.name for planter in PLANTERS)
    raise DataError(f"there is no planter {name!r}", advice=f"Planters: {known}")
