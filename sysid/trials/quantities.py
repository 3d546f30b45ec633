"""What a planter's own quantities are in the parameters of the catalogue's effect."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from sysid.effects.base import AbstractEffect
from sysid.effects.registry import choice_of
from sysid.rig.trial_campaign import Trial

Values = dict[str, float]


@dataclass(frozen=True)
class TrueQuantity:
    """The true value of a parameter of an effect.

    Attributes:
        id: Of the effect.
        symbol: Of its parameter.
        value: SI.
        exact: Planter and effect have the same law, so that an interval should cover the value;
            otherwise it is that of the nearest law of the effect's form.
        form: Of the effect's choices, those that the value belongs to; any if empty.
    """

    id: str
    symbol: str
    value: float
    exact: bool
    form: Mapping[str, str] = field(default_factory=dict)

    def of(self, effect: AbstractEffect) -> bool:
        """The value belongs to the form that an effect has."""
        return effect.facts.id == self.id and self.form.items() <= choice_of(effect).items()


@dataclass(frozen=True)
class _Law:
    symbol: str
    value: Callable[[Values, Trial], float]
    exact: bool = True
    form: Mapping[str, str] = field(default_factory=dict)


def _same(symbol: str, *, exact: bool = True, sign: float = 1.0) -> _Law:
    """The parameter is the planter's `size` itself."""
    return _Law(symbol, lambda q, trial: sign * q["size"], exact)


def _chamber_stiffness(q: Values, trial: Trial) -> float:
    """N P A²/V, with the widest stroke that it was built for 2 % of V."""
    stroke = trial.design.stroke
    if stroke is None:
        stroke = float(np.max(trial.loops.amplitude[: len(trial.visits[0])]))
    volume = q["rod_area"] * stroke / 0.02
    return q["exponent"] * q["size"] * q["rod_area"] ** 2 / volume


def _consistency(q: Values, trial: Trial) -> float:
    """Force of a slot flow at 1 m/s: 2 L/h A_p K ((4n + 2)/n · A_p/(w h²))ⁿ."""
    n = q["index"]
    rate = (4.0 * n + 2.0) / n * q["piston_area"] / (q["width"] * q["gap"] ** 2)
    return q["piston_area"] * 2.0 * q["length"] / q["gap"] * q["size"] * rate**n


def _jet_loss(q: Values, trial: Trial) -> float:
    """ρ/2 C_d⁻² A_p (A_p/A_o)²."""
    return 0.5 * q["size"] * q["piston_area"] * (q["piston_area"] / q["hole_area"]) ** 2


_LAWS: Final[dict[str, tuple[_Law, ...]]] = {
    "gas_preload": (_Law("F_off", lambda q, t: q["size"] * q["rod_area"]),),
    "large_gas_chamber": (_Law("k_g", _chamber_stiffness),),
    "balanced_gas_chamber": (
        _Law("F_g", lambda q, t: q["size"] * q["rod_area"]),
        _Law("x_g", lambda q, t: q["volume"] / q["rod_area"]),
        _Law("n_g", lambda q, t: q["exponent"]),
    ),
    "warm_gas": (
        _Law("c_gT", lambda q, t: q["size"] * q["rod_area"] / (q["filling_temperature"] + 273.15)),
    ),
    "oil_column": (
        _Law("m_f", lambda q, t: q["density"] * q["size"] * q["piston_area"] ** 2 / q["gap_area"]),
    ),
    "late_sampling": (_same("tau_F"),),
    "butterworth_channel": (
        _Law("tau_c", lambda q, t: q["size"], form={"poles": "two"}),
        _Law("tau_c", lambda q, t: math.sqrt(2.0) * q["size"], exact=False, form={"poles": "one"}),
    ),
    "stiff_seal": (_same("F_c"),),
    "breakaway_seal": (
        _same("F_s", exact=False),
        _Law("v_st", lambda q, t: q["film_speed"], exact=False),
        _Law("sigma_0", lambda q, t: q["stiffness"], exact=False),
    ),
    "soft_seal": (_same("F_ps"), _Law("sigma_0", lambda q, t: q["size"] / q["bend"])),
    "side_load": (_same("c_xf"),),
    "soft_mount": (_same("s_k"),),
    "rod_play": (_same("delta"),),
    "loose_pin": (_same("delta"),),
    "gas_pocket": (_same("delta_a", exact=False),),
    "shear_thinning_gap": (
        _Law("K_hb", _consistency),
        _Law("n_hb", lambda q, t: q["index"]),
    ),
    "orifice": (_Law("c_2", _jet_loss),),
    "oil_film": (
        _Law("c_1", lambda q, t: q["size"] * math.pi * q["diameter"] * q["length"] / q["film"]),
    ),
    "leaking_piston": (_same("k_l"),),
    "vogel_oil": (_same("beta_v", exact=False, sign=-1.0),),
    "warm_particles": (_same("beta_y", exact=False, sign=-1.0),),
    "eddy_currents": (_same("eta_e", exact=False),),
    "bent_load_cell": (_same("g_a"),),
    "heated_oil": (_same("r_h", exact=False),),
    "settled_particles": (
        _Law("F_br", lambda q, t: q["size"] * math.exp(-0.5 / q["stirring"]), exact=False),
        _Law("n_br", lambda q, t: q["stirring"], exact=False),
    ),
    "body_thermometer": (_same("R_th", exact=False),),
    "converter_limit": (
        _Law("q_F", lambda q, t: 1.0 / float(np.max(np.abs(t.truth.force)))),
    ),
}  # fmt: skip
"""Planter → its quantities; planters that are missing have none of their effect's form."""


def true_quantities(trial: Trial) -> tuple[TrueQuantity, ...]:
    """True values of parameters of the catalogue's effects, as far as they are defined."""
    return tuple(
        TrueQuantity(planter.causes[0], law.symbol, law.value(values, trial), law.exact, law.form)
        for planter, values in zip(trial.truth.planters, trial.truth.nominal, strict=True)
        for law in _LAWS.get(planter.name, ())
    )
