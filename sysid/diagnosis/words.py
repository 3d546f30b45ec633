"""Names and units for people: where an id or an SI unit becomes engineers' language."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from sysid.diagnosis.result import Quantity

EFFECT_WORDS: Final[Mapping[str, str]] = {
    "force_offset": "an offset of the force (static gas force or load-cell zero)",
    "load_cell_gain": "a gain error of the load cell",
    "gas_spring": "a gas spring",
    "gas_polytropic": "a polytropic gas spring",
    "gas_temperature": "gas pressure that changes with temperature",
    "fluid_inertia": "inertia of the fluid",
    "fixture_inertia": "inertia of the fixture",
    "force_delay": "a delay of the force channel",
    "force_filter": "a filter in the force channel",
    "velocity_delay": "a delay of the velocity channel",
    "seal_friction": "Coulomb friction of the seal",
    "stribeck_friction": "Stribeck friction",
    "presliding_friction": "friction with a presliding spring",
    "position_friction": "friction that depends on the position (side load)",
    "series_compliance": "a compliance in series (mount or fluid)",
    "backlash": "lost motion (backlash)",
    "entrained_air": "lost motion on one side (entrained air or cavitation)",
    "shear_thinning": "shear thinning",
    "quadratic_loss": "a loss that grows with the square of speed",
    "linear_viscosity": "linear viscosity",
    "frequency_law": "a force law that depends on frequency",
    "viscosity_temperature": "viscosity that changes with temperature",
    "yield_temperature": "yield force that changes with temperature",
    "stiffness_temperature": "stiffness that changes with temperature",
    "residual_magnetism": "residual magnetism",
    "magnetic_hysteresis": "magnetic hysteresis",
    "coil_lag": "lag of the coil current",
    "eddy_loss": "loss of field at speed (eddy currents)",
    "current_saturation": "saturation of the current",
    "bypass_leakage": "leakage past the piston",
    "bump_stop": "a stop near the end of the stroke",
    "asymmetric_gain": "a gain that differs between compression and rebound",
    "force_clipping": "clipping of the force channel",
    "force_quantization": "coarse steps of the force channel",
    "mains_hum": "mains hum",
    "displacement_zero": "a wrong zero of the displacement",
    "waveform_distortion": "a motion that is no pure sine",
    "first_cycle_breakaway": "breakaway in the first cycles",
    "self_heating": "heating of the oil within a test",
    "surface_temperature": "oil that is warmer than the body that is measured",
    "run_drift": "drift over the campaign (wear, loss of gas, a fluid that thickens)",
    "seating_leakage": "leakage until a loose part is seated after a reversal",
    "width_law": "a loop width that goes with travel instead of speed",
    "guide_friction": "friction of the rod guide that grows as the rod comes out (side load)",
}  # fmt: skip
"""Id of an effect → its name in a sentence, with its article."""

FORM_WORDS: Final[Mapping[str, tuple[str, Mapping[str | int, str]]]] = {
    "asymmetric_gain": (
        "turns",
        {
            "velocity": "changing with the direction of motion, as valves do",
            "force": "changing with the sign of the force, as load cells do",
        },
    ),
    "entrained_air": ("side", {1: "in compression", -1: "in rebound"}),
    "frequency_law": (
        "part",
        {"yield": "in its yield part", "viscous": "in its viscous part"},
    ),
}
"""Id of an effect → the field that tells its form, and what a sentence says of each."""

FAMILY_WORDS: Final[Mapping[str, str]] = {
    "offset": "offsets and asymmetry of the force",
    "acquisition": "faults of the measuring chain",
    "reactive": "springs and masses",
    "gas_nonlinear": "non-linear gas forces",
    "timing": "delays and compliances",
    "friction": "friction",
    "lost_motion": "lost motion",
    "viscous": "viscous losses",
    "rate_law": "laws that depend on frequency or amplitude",
    "thermal": "effects of temperature",
    "current_law": "laws of the current",
    "run_history": "effects of what was run before",
}
"""Family of effects → its name in a sentence."""

MODEL_WORDS: Final[Mapping[str, str]] = {
    "generalized": "generalised hysteresis model",
    "tanh": "tanh model",
    "dahl": "Dahl model",
    "bouc_wen": "Bouc–Wen model",
    "modified_bouc_wen": "modified Bouc–Wen model",
    "carreau": "Carreau–Yasuda model",
    "lumped": "lumped model",
}
"""Name of a base model → its name in a sentence."""


@dataclass(frozen=True)
class Shown:
    """How a parameter is shown.

    Attributes:
        unit: What engineers write.
        factor: SI to that unit.
        inverse: Shown is 1/value (for limits, which cards hold inverted).
        name: In words, where the parameter's own name does not fit what is shown.
    """

    unit: str
    factor: float = 1.0
    inverse: bool = False
    name: str | None = None


SHOWN_UNITS: Final[Mapping[str, Shown]] = {
    "m": Shown("mm", 1e3),
    "s": Shown("ms", 1e3),
    "N": Shown("N"),
    "kg": Shown("kg"),
    "A": Shown("mA", 1e3),
    "K/J": Shown("K/kJ", 1e3),
    "K/W": Shown("K/W"),
    "1/s": Shown("1/s"),
    "m/s": Shown("mm/s", 1e3),
    "N/m": Shown("kN/m", 1e-3),
    "N/K": Shown("N/K"),
    "m/N": Shown("mm/kN", 1e6),
    "1/K": Shown("%/K", 1e2),
    "-": Shown("%", 1e2),
    "1/A": Shown("1/A"),
    "1/N": Shown("1/N"),
    "s/m": Shown("% per m/s", 1e2),
    "m/(s·N)": Shown("mm/s per kN", 1e6),
    "N·s/m": Shown("N·s/m"),
    "N·s²/m²": Shown("N·s²/m²"),
    "N·(s/m)^n": Shown("N·(s/m)^n"),
}
"""SI unit of a parameter → how it is shown."""

SHOWN_SYMBOLS: Final[Mapping[str, Shown]] = {
    "eps_f": Shown("% per decade", 1e2),
    "p_w": Shown("(0: speed, 1/2: constant travel)"),
    "n_br": Shown("cycles"),
    "n_g": Shown("(a pure number)"),
    "n_hb": Shown("(a pure number)"),
    "n_s": Shown("(a pure number)"),
    "q_s": Shown("A", inverse=True, name="saturation current"),
    "q_F": Shown("N", inverse=True, name="limit of the force"),
}
"""Symbols that are shown otherwise than their unit says."""

NOT_DETERMINED: Final = "not determined by these tests"

CURRENT_STEPS_PER_AMPERE: Final = 1e4
"""Currents are shown to 0.1 mA: measured ones differ in digits that nobody set."""


def shown(symbol: str, unit: str) -> Shown:
    """How a parameter is shown: in its own unit where no better one is known."""
    return SHOWN_SYMBOLS.get(symbol) or SHOWN_UNITS.get(unit) or Shown(unit)


def amount(q: Quantity) -> str:
    """A parameter's value with its interval, e.g. ``0.41 ± 0.02 mm``, as sentences have it.

    The interval is that of `Quantity.level`.  Where it is lopsided both its ends are given; where
    the data do not determine the parameter, that is said by its name and no value is.
    """
    told = amount_beside_name(q)
    return f"{_name(q)} {told}" if told == NOT_DETERMINED else told


def amounts(of: str, quantities: Sequence[Quantity]) -> str:
    """All parameters of an effect in a row; at its end those that are not determined, by name.

    Args:
        of: What the effect is called: a parameter of the same name is told without it.
        quantities: Its parameters.
    """
    if len(quantities) == 1:
        return amount(quantities[0])
    told = [(_name(q), amount_beside_name(q)) for q in quantities]
    known = [
        size if name.casefold() == of.casefold() else f"{name} {size}"
        for name, size in told
        if size != NOT_DETERMINED
    ]
    vague = listed([name for name, size in told if size == NOT_DETERMINED])
    return ", ".join(z for z in (listed(known), f"{vague} {NOT_DETERMINED}" if vague else "") if z)


def _name(q: Quantity) -> str:
    return shown(q.symbol, q.unit).name or q.name


def amount_beside_name(q: Quantity) -> str:
    """The same where its name stands beside it, as in a table."""
    view = shown(q.symbol, q.unit)
    if not q.identified or not math.isfinite(q.value):
        return NOT_DETERMINED
    value, low, high = (_viewed(z, view) for z in (q.value, q.low, q.high))
    low, high = min(low, high), max(low, high)
    if not (math.isfinite(low) and math.isfinite(high)):
        return f"{plain(value, 3)} {view.unit}"
    half = 0.5 * (high - low)
    if half <= 0.0:
        return f"{plain(value, 3)} {view.unit}"
    if abs((high - value) - (value - low)) > 0.3 * half:
        digits = _digits(half)
        ends = f"{_fixed(low, digits)} … {_fixed(high, digits)}"
        return f"{_fixed(value, digits)} {view.unit} ({ends} {view.unit})"
    digits = _digits(half)
    return f"{_fixed(value, digits)} ± {_fixed(half, digits)} {view.unit}"


def size_words(symbol: str, unit: str, value: float) -> str:
    """A value alone in an engineer's unit, e.g. ``12 N``."""
    view = shown(symbol, unit)
    return f"{plain(_viewed(value, view), 2)} {view.unit}"


def plain(value: float, digits: int = 2) -> str:
    """A number rounded to some significant digits, never written with an exponent of ten."""
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}"
    return _fixed(value, digits - 1 - math.floor(math.log10(abs(float(f"{value:.{digits - 1}e}")))))


def count(value: float) -> str:
    """A large pure number as people say it, e.g. ``55 000`` or ``12 million``."""
    if value >= 1e6:
        return f"{plain(1e-6 * value)} million"
    if value >= 1e4:
        return f"{float(plain(value)):,.0f}".replace(",", " ")
    return f"{value:.0f}"


def percent(share: float) -> str:
    """A share as per cent with two significant digits, e.g. ``9.7 %``."""
    if not math.isfinite(share):
        return "unknown"
    value = 100.0 * share
    return f"{plain(value, 3 if abs(value) >= 99.5 else 2)} %"


def part_interval(low: float, high: float) -> str:
    """The 95 % interval of a part of a whole, in words; empty where it is not known.

    Above the whole, an interval only says that the tests cannot tell: that end is left out.

    Args:
        low: Lower end, 1 being the whole.
        high: Upper end.
    """
    if not (math.isfinite(low) and math.isfinite(high)):
        return ""
    if high <= 1.0:
        return f"95 % interval {percent(low)} to {percent(high)}"
    if low > 0.0:
        return f"95 % interval: at least {percent(low)}"
    return "95 % interval: anything from nothing to all of it"


def listed(names: Sequence[str], last: str = "and") -> str:
    """Names in a row, e.g. ``a, b and c``."""
    if len(names) < 2:
        return "".join(names)
    return f"{', '.join(names[:-1])} {last} {names[-1]}"


def capital(text: str) -> str:
    """The same as the beginning of a sentence."""
    return text[:1].upper() + text[1:]


def condition_words(amplitude: float, frequency: float, current: float) -> str:
    """A test's condition, e.g. ``25 mm, 0.5 Hz and 2 A``.

    Args:
        amplitude: m.
        frequency: Hz.
        current: A; left out where unknown.
    """
    told = [f"{1e3 * amplitude:.3g} mm", f"{frequency:.3g} Hz"]
    if math.isfinite(current):
        told.append(current_words(current))
    return listed(told)


def current_words(current: float) -> str:
    """A current as it was meant, e.g. ``0.4 A``, though 0.4002 A was measured.

    Args:
        current: A.
    """
    return f"{_current(current):.3g} A"


def _current(value: float) -> float:
    return round(value * CURRENT_STEPS_PER_AMPERE) / CURRENT_STEPS_PER_AMPERE + 0.0


def _viewed(value: float, view: Shown) -> float:
    if view.inverse:
        return math.inf if value == 0.0 else view.factor / value
    return view.factor * value


def _digits(error: float) -> int:
    """Decimals that leave one digit of an error, two where the first is a 1."""
    first = math.floor(math.log10(error))
    return -first + (1 if error / 10.0**first < 1.95 else 0)


def _fixed(value: float, decimals: int) -> str:
    if decimals >= 0:
        return f"{value:.{decimals}f}"
    return f"{round(value, decimals):.0f}"
