"""A damper whose force as a whole grows with frequency, whatever the motion."""

from typing import Any

import equinox as eqx

from sysid.isolator.damper_step import AbstractDamperStep
from sysid.isolator.fractional_power import FractionalPower, fractional_power
from sysid.isolator.implicit_stage import Port, onward
from sysid.isolator.plant import Number


class FrequencyDependent(AbstractDamperStep):
    """A damper and a filter of its force.

    Attributes:
        inner: The damper.
        power: The filter.
        tau: Of the inner one, s.
        currents: Of the inner one, A.
    """

    inner: AbstractDamperStep
    power: FractionalPower
    tau: Number
    currents: tuple[float, ...] = eqx.field(static=True)

    def start(self) -> tuple[Any, tuple[Number, ...]]:
        """At rest."""
        return self.inner.start(), self.power.start()

    def stage(self, known: Any, meets: Port, current: Number) -> tuple[Any, Number]:
        """The inner damper meets what the filter leaves of the plant."""
        element, cells = known
        filtered = self.power.met(cells, meets.length)
        direct, past = filtered.direct, filtered.past
        seen = Port(
            meets.velocity - meets.mobility * past, meets.mobility * direct,
            meets.displacement + meets.shift * past, meets.shift * direct, meets.length,
        )  # fmt: skip
        element, force = self.inner.stage(element, seen, current)
        return (element, filtered.after(force)), direct * force + past

    def carried(self, begin: Any, first: Any) -> Any:
        """As the inner damper has it, and the filter's states linearly."""
        cells = tuple(onward(y, z) for y, z in zip(begin[1], first[1], strict=True))
        return self.inner.carried(begin[0], first[0]), cells


def frequency_dependent(
    inner: AbstractDamperStep, per_decade: Number | float
) -> FrequencyDependent:
    """A damper whose force changes by ε per decade of frequency and is its own at 1 Hz.

    Args:
        inner: The damper.
        per_decade: ε.
    """
    return FrequencyDependent(
        inner=inner,
        power=fractional_power(per_decade),
        tau=inner.tau,
        currents=inner.currents,
    )
