"""A scenario: which damper is tested how, and what a reader may know of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import product

from sysid.rig.bench import Bench, Setting


@dataclass(frozen=True)
class Scenario:
    """A virtual campaign, complete but for its random numbers.

    Attributes:
        id: Name on the command line, and of the dataset's folder.
        title: Name of the campaign.
        about: What the damper and the design are, for the dataset's page; no parameter values.
        parameters: Of the damper, symbol → value, SI.
        settings: The tests, in the order of the design.
        seed: Of the random numbers.
        bench: Imperfections of the rig.
    """

    id: str
    title: str
    about: str
    parameters: Mapping[str, float]
    settings: tuple[Setting, ...]
    seed: int
    bench: Bench = field(default_factory=Bench)


def full_factorial(
    amplitudes: tuple[float, ...], frequencies: tuple[float, ...], currents: tuple[float, ...]
) -> tuple[Setting, ...]:
    """Every combination of amplitudes (m), frequencies (Hz) and currents (A)."""
    return tuple(Setting(a, f, i) for a, f, i in product(amplitudes, frequencies, currents))
