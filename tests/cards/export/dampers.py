"""Dampers that between them have every model and every effect that can be exported."""

from functools import cache

from sysid.cards.models import MODELS
from sysid.effects.base import AbstractEffect
from sysid.effects.registry import choices, effect_kind
from sysid.models.base import AbstractValve
from sysid.models.damper import Damper
from sysid.models.generalized import ASYMMETRIC
from sysid.models.lumped import TABLE_1, Lumped
from sysid.parameters import build, specs

RIVAL = {
    "c_a": 800.0, "c_b": 900.0, "k": 1500.0, "k_0": 1500.0, "f_0": 40.0, "alpha_a": 100.0,
    "alpha_b": 2500.0, "beta": 60.0, "delta_a": 0.4, "delta_b": 0.6, "q": 1.3, "rho": 3000.0,
    "sigma": 0.7, "c_0a": 800.0, "c_0b": 900.0, "c_1a": 2e4, "c_1b": 1e5, "k_1": 800.0,
    "v_0": 0.01, "n": 1.2, "h_a": 0.002, "h_b": 0.01, "i_s": 0.3, "m": 1.4,
}  # fmt: skip


@cache
def valve(model: str) -> AbstractValve:
    if model == "generalized":
        return build(MODELS[model], ASYMMETRIC)
    if model == "lumped":
        return build(Lumped, TABLE_1)
    kind = MODELS[model]
    return build(kind, {spec.symbol: RIVAL[spec.symbol] for spec in specs(kind)})


def effect(id: str, **changed: object) -> AbstractEffect:
    kind = effect_kind(id)
    values = {**kind.facts.nominal, **choices(kind)[0], **changed}
    return kind(**values)


CASES: dict[str, tuple[str, tuple[AbstractEffect, ...]]] = {
    "forces": (
        "generalized",
        (
            effect("gas_spring"), effect("gas_polytropic"), effect("gas_temperature"),
            effect("fluid_inertia"), effect("fixture_inertia"), effect("seal_friction"),
            effect("stribeck_friction"), effect("presliding_friction"),
            effect("position_friction"), effect("guide_friction"), effect("shear_thinning"),
            effect("quadratic_loss"), effect("linear_viscosity"),
            effect("bump_stop", x_b=0.006), effect("force_offset"), effect("load_cell_gain"),
        ),
    ),
    "laws": (
        "generalized",
        (
            effect("viscosity_temperature"), effect("yield_temperature"), effect("eddy_loss"),
            effect("stiffness_temperature"), effect("width_law", part="yield"),
            effect("bypass_leakage"), effect("seating_leakage"), effect("seal_friction"),
        ),
    ),
    "spring": (
        "generalized",
        (
            effect("displacement_zero"), effect("series_compliance"), effect("backlash"),
            effect("bypass_leakage"), effect("presliding_friction"),
            effect("asymmetric_gain", turns="velocity"),
        ),
    ),
    "channel": (
        "tanh",
        (
            effect("coil_lag"), effect("current_saturation"), effect("residual_magnetism"),
            effect("backlash", joint="loose"), effect("entrained_air", side=-1),
            effect("force_filter", poles="one"), effect("force_filter", poles="two"),
            effect("asymmetric_gain", turns="force"), effect("force_delay"), effect("mains_hum"),
            effect("force_clipping", q_F=1 / 600.0),
            effect("force_quantization"),
        ),
    ),
    "tanh_with_laws": (
        "tanh",
        (effect("viscosity_temperature"), effect("eddy_loss"), effect("bypass_leakage")),
    ),
    "carreau_in_its_rig": (
        "carreau",
        (effect("series_compliance"), effect("bypass_leakage"), effect("yield_temperature")),
    ),
    "carreau": ("carreau", (effect("width_law", part="whole"), effect("seating_leakage"))),
    "dahl": ("dahl", (effect("series_compliance", s_k=1e-7), effect("seal_friction"))),
    "bouc_wen": (
        "bouc_wen",
        (effect("velocity_delay"), effect("entrained_air"), effect("eddy_loss")),
    ),
    "modified_bouc_wen": ("modified_bouc_wen", (effect("eddy_loss"), effect("backlash"))),
    "modified_bouc_wen_in_its_rig": (
        "modified_bouc_wen",
        (
            effect("series_compliance", s_k=1e-7), effect("bypass_leakage"),
            effect("stiffness_temperature"), effect("viscosity_temperature"),
        ),
    ),
    "bouc_wen_in_its_rig": (
        "bouc_wen",
        (
            effect("backlash"), effect("series_compliance", s_k=1e-7), effect("seating_leakage"),
            effect("presliding_friction"), effect("yield_temperature"),
        ),
    ),
    "lumped": (
        "lumped",
        (
            effect("series_compliance", s_k=1e-7), effect("bypass_leakage"), effect("eddy_loss"),
            effect("viscosity_temperature"), effect("stiffness_temperature"),
            effect("yield_temperature"),
        ),
    ),
    "lumped_in_its_rig": (
        "lumped",
        (
            effect("backlash"), effect("series_compliance", s_k=1e-7), effect("seating_leakage"),
            effect("presliding_friction"), effect("fluid_inertia"),
        ),
    ),
}  # fmt: skip


def damper(case: str) -> Damper:
    model, effects = CASES[case]
    return Damper(valve(model), effects)
