"""Whether a motion lies in the box of conditions that a card was identified in.

Asks for no more than plain numbers.
"""

from dataclasses import dataclass

from sysid.cards.schema import Pair, Validity
from sysid.data.supply import same_current

SLACK = 0.02
"""A condition counts as inside up to 2 % beyond an end of the box: actuators do not hit their
label, so a card identified at a nominal 25 mm says 24.9 mm.  Of current it is what is one setting
of the supply (`same_current`): a card identified at 0 A says what its meter showed."""


TEMPERATURE_SLACK = 2.0
"""K; two thermocouples of the usual class (±1.5 K) differ by that much."""


@dataclass(frozen=True)
class Instants:
    """What counts as inside of the conditions that an instant of a motion has.

    Attributes:
        reach: m, largest distance from the centre.
        speed: m/s, largest.
        current: A, smallest and largest.
        temperature: °C, smallest and largest; None where not known.
    """

    reach: float
    speed: float
    current: Pair
    temperature: Pair | None


def instants(validity: Validity) -> Instants:
    """The ends of a box with their slack, as `outside` holds a motion against them.

    Args:
        validity: The box.
    """
    warm = validity.temperature
    return Instants(
        reach=_wider(validity.amplitude)[1],
        speed=_wider(validity.velocity)[1],
        current=_wider(validity.current, _meter(validity)),
        temperature=None if warm is None else _wider(warm, TEMPERATURE_SLACK),
    )


def _meter(validity: Validity) -> float:
    """A; currents that differ by no more are one setting of the supply."""
    return same_current(max(abs(validity.current[0]), abs(validity.current[1])))


def _wider(box: Pair, slack: float | None = None) -> Pair:
    """A box with its slack, 2 % of its larger end where none is given."""
    slack = SLACK * max(abs(box[0]), abs(box[1])) if slack is None else slack
    return box[0] - slack, box[1] + slack


def outside(
    validity: Validity,
    *,
    velocity: float,
    current: Pair,
    amplitude: float | None = None,
    frequency: float | None = None,
    reach: float | None = None,
    temperature: Pair | None = None,
) -> tuple[str, ...]:
    """Say in which respects a motion leaves the box.

    Args:
        validity: The box.
        velocity: Largest speed, m/s.
        current: Smallest and largest current, A.
        amplitude: Of a sinusoid, m; held against both ends of the box.
        frequency: Of a sinusoid, Hz.
        reach: Largest distance from the centre of any other motion, m; only the upper end counts.
        temperature: Smallest and largest, °C; None where not given.

    Returns:
        One sentence a condition, empty inside the box.
    """
    told: list[str] = []

    def hold(
        name: str,
        low: float,
        high: float,
        box: Pair,
        unit: str,
        size: float,
        slack: float | None = None,
    ) -> None:
        least, most = _wider(box, slack)
        if low < least or high > most:
            asked = f"{low / size:.4g}" if low == high else f"{low / size:.4g} to {high / size:.4g}"
            inside = f"{box[0] / size:.4g} to {box[1] / size:.4g}"
            told.append(f"{name} {asked} {unit} is outside {inside} {unit}")

    if amplitude is not None:
        hold("amplitude", amplitude, amplitude, validity.amplitude, "mm", 1e-3)
    if reach is not None:
        hold("displacement", reach, reach, (0.0, validity.amplitude[1]), "mm", 1e-3)
    if frequency is not None and validity.frequency is not None:
        hold("frequency", frequency, frequency, validity.frequency, "Hz", 1.0)
    hold("velocity", velocity, velocity, validity.velocity, "m/s", 1.0)
    hold("current", *current, validity.current, "A", 1.0, _meter(validity))
    if temperature is not None and validity.temperature is not None:
        low, high = validity.temperature
        least, most = _wider(validity.temperature, TEMPERATURE_SLACK)
        if temperature[0] < least or temperature[1] > most:
            asked = " to ".join(f"{t:.4g}" for t in dict.fromkeys(temperature))
            told.append(f"temperature {asked} °C is outside {low:.4g} to {high:.4g} °C")
    return tuple(told)
