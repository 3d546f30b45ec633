"""One ordinary damper of each rival model, and the motions they are tested on."""

from typing import Final

from sysid.models.base import AbstractValve
from sysid.models.bouc_wen import BoucWen
from sysid.models.carreau import Carreau
from sysid.models.coordinates import Reference
from sysid.models.dahl import Dahl
from sysid.models.modified_bouc_wen import ModifiedBoucWen
from sysid.models.tanh_kwok import TanhKwok
from sysid.parameters import build

REFERENCE: Final = Reference(force=600.0, speed=0.39, current=0.4, length=0.025)

_LAWS: Final = {"alpha_a": 150.0, "alpha_b": 1500.0, "q": 0.5, "f_0": 40.0}
_VISCOUS: Final = {"c_a": 600.0, "c_b": 1500.0}

EXAMPLES: Final[dict[str, tuple[type[AbstractValve], dict[str, float]]]] = {
    "tanh": (
        TanhKwok,
        _LAWS | _VISCOUS | {"k": 400.0, "beta": 60.0, "delta_a": 0.4, "delta_b": 1.0},
    ),
    "dahl": (Dahl, _LAWS | _VISCOUS | {"k_0": 400.0, "rho": 1500.0}),
    "bouc_wen": (BoucWen, _LAWS | _VISCOUS | {"k_0": 400.0, "rho": 1500.0, "sigma": 1.5}),
    "modified_bouc_wen": (
        ModifiedBoucWen,
        _LAWS
        | {"c_0a": 600.0, "c_0b": 1500.0, "c_1a": 8000.0, "c_1b": 6000.0}
        | {"k_0": 2000.0, "k_1": 400.0, "rho": 1500.0, "sigma": 1.5},
    ),
    "carreau": (
        Carreau,
        {"alpha_a": 150.0, "alpha_b": 1500.0, "f_0": 40.0, "i_s": 0.3, "m": 1.5}
        | {"c_a": 600.0, "c_b": 1500.0, "k": 400.0, "v_0": 0.01, "n": 0.8}
        | {"h_a": 0.004, "h_b": 0.006},
    ),
}  # fmt: skip

_FORCES: Final = ("alpha_a", "alpha_b", "f_0")
_VISCOSITIES: Final = ("c_a", "c_b", "c_0a", "c_0b", "c_1a", "c_1b")


def example(name: str, **changes: float) -> AbstractValve:
    """The damper of a model with some of its values changed."""
    kind, values = EXAMPLES[name]
    return build(kind, values | changes)


def in_other_units(name: str, force: float, length: float, current: float) -> AbstractValve:
    """The same damper where forces, lengths and currents are given by larger numbers."""
    kind, values = EXAMPLES[name]
    scale = dict.fromkeys(_FORCES, force) | dict.fromkeys(_VISCOSITIES, force / length)
    scale |= dict.fromkeys(("k", "k_0", "k_1"), force / length)
    scale |= dict.fromkeys(("rho", "beta"), 1.0 / length)
    scale |= {"q": 1.0 / current, "delta_b": 1.0, "i_s": current}
    scale |= dict.fromkeys(("v_0", "h_a", "h_b"), length)
    changed = {symbol: value * scale.get(symbol, 1.0) for symbol, value in values.items()}
    for symbol in ("alpha_b", "c_b", "c_0b", "c_1b", "delta_b"):
        if symbol in changed and "q" in changed:  # a rise per ampere, not up to saturation
            changed[symbol] /= current
    return build(kind, changed)
