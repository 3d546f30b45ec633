"""All effects, in the order of the catalogue; a new one goes to the end."""

from collections.abc import Mapping
from typing import Final, Literal

from sysid.effects.base import AbstractEffect
from sysid.effects.channel.asymmetric_gain import AsymmetricGain
from sysid.effects.channel.force_clipping import ForceClipping
from sysid.effects.channel.force_delay import ForceDelay
from sysid.effects.channel.force_filter import ForceFilter
from sysid.effects.channel.force_offset import ForceOffset
from sysid.effects.channel.force_quantization import ForceQuantization
from sysid.effects.channel.load_cell_gain import LoadCellGain
from sysid.effects.channel.mains_hum import MainsHum
from sysid.effects.drive.coil_lag import CoilLag
from sysid.effects.drive.current_saturation import CurrentSaturation
from sysid.effects.drive.magnetic_hysteresis import MagneticHysteresis
from sysid.effects.drive.residual_magnetism import ResidualMagnetism
from sysid.effects.force.bump_stop import BumpStop
from sysid.effects.force.first_cycle_breakaway import FirstCycleBreakaway
from sysid.effects.force.fixture_inertia import FixtureInertia
from sysid.effects.force.fluid_inertia import FluidInertia
from sysid.effects.force.gas_polytropic import GasPolytropic
from sysid.effects.force.gas_spring import GasSpring
from sysid.effects.force.gas_temperature import GasTemperature
from sysid.effects.force.guide_friction import GuideFriction
from sysid.effects.force.linear_viscosity import LinearViscosity
from sysid.effects.force.position_friction import PositionFriction
from sysid.effects.force.presliding_friction import PreslidingFriction
from sysid.effects.force.quadratic_loss import QuadraticLoss
from sysid.effects.force.seal_friction import SealFriction
from sysid.effects.force.shear_thinning import ShearThinning
from sysid.effects.force.stribeck_friction import StribeckFriction
from sysid.effects.law.bypass_leakage import BypassLeakage
from sysid.effects.law.eddy_loss import EddyLoss
from sysid.effects.law.frequency_law import FrequencyLaw
from sysid.effects.law.run_drift import RunDrift
from sysid.effects.law.seating_leakage import SeatingLeakage
from sysid.effects.law.self_heating import SelfHeating
from sysid.effects.law.stiffness_temperature import StiffnessTemperature
from sysid.effects.law.surface_temperature import SurfaceTemperature
from sysid.effects.law.viscosity_temperature import ViscosityTemperature
from sysid.effects.law.width_law import WidthLaw
from sysid.effects.law.yield_temperature import YieldTemperature
from sysid.effects.motion.backlash import Backlash
from sysid.effects.motion.displacement_zero import DisplacementZero
from sysid.effects.motion.entrained_air import EntrainedAir
from sysid.effects.motion.series_compliance import SeriesCompliance
from sysid.effects.motion.velocity_delay import VelocityDelay
from sysid.effects.motion.waveform_distortion import WaveformDistortion

EFFECTS: Final[tuple[type[AbstractEffect], ...]] = (
    ForceOffset,
    LoadCellGain,
    GasSpring,
    GasPolytropic,
    GasTemperature,
    FluidInertia,
    FixtureInertia,
    ForceDelay,
    ForceFilter,
    VelocityDelay,
    SealFriction,
    StribeckFriction,
    PreslidingFriction,
    PositionFriction,
    SeriesCompliance,
    Backlash,
    EntrainedAir,
    ShearThinning,
    QuadraticLoss,
    LinearViscosity,
    FrequencyLaw,
    ViscosityTemperature,
    YieldTemperature,
    SelfHeating,
    StiffnessTemperature,
    ResidualMagnetism,
    MagneticHysteresis,
    CoilLag,
    EddyLoss,
    CurrentSaturation,
    BypassLeakage,
    BumpStop,
    AsymmetricGain,
    ForceClipping,
    ForceQuantization,
    MainsHum,
    DisplacementZero,
    WaveformDistortion,
    FirstCycleBreakaway,
    RunDrift,
    SurfaceTemperature,
    SeatingLeakage,
    WidthLaw,
    GuideFriction,
)

Choice = Mapping[str, str | int]
"""Fields of an effect that are no parameters, and what they are."""

CHOICES: Final[Mapping[str, tuple[Choice, ...]]] = {
    "asymmetric_gain": ({"turns": "velocity"}, {"turns": "force"}),
    "backlash": ({"joint": "held"}, {"joint": "loose"}),
    "force_filter": ({"poles": "one"}, {"poles": "two"}),
    "entrained_air": ({"side": 1}, {"side": -1}),
    "frequency_law": ({"part": "whole"}, {"part": "yield"}, {"part": "viscous"}),
    "width_law": ({"part": "whole"}, {"part": "yield"}),
}
"""Id → the forms that an effect comes in; all others have one form, without choices."""


def choices(kind: type[AbstractEffect]) -> tuple[Choice, ...]:
    """The forms of an effect, each as fields to give to it beside its parameters."""
    return CHOICES.get(kind.facts.id, ({},))


def choice_of(effect: AbstractEffect) -> Choice:
    """The form that an effect has."""
    return {field: getattr(effect, field) for field in choices(type(effect))[0]}


def make(
    kind: type[AbstractEffect],
    size: Literal["nominal", "zero"] | float = "nominal",
    choice: Choice | None = None,
) -> AbstractEffect:
    """An effect at realistic values, its size nominal, zero or as given.

    Args:
        kind: A member of `EFFECTS`.
        size: Of the parameter `facts.size`, SI.
        choice: A member of `choices(kind)`; the first if not given.
    """
    values = dict(kind.facts.nominal)
    if size != "nominal":
        values[kind.facts.size] = 0.0 if size == "zero" else float(size)
    return kind(**values, **(choice or choices(kind)[0]))


def effect_kind(id: str) -> type[AbstractEffect]:
    """The effect of an id.

    Raises:
        KeyError: There is none.
    """
    return {kind.facts.id: kind for kind in EFFECTS}[id]
