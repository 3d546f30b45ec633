"""What every effect is: an idea with an id, a place on the signal path, and claims that are tested.

The signal path is

    drive (command → effective current) → motion (recorded → at the valve) →
    law (how the valve's parts depend on frequency, temperature, …) → force (in parallel) →
    channel (true → recorded force)

Each stage has an abstract class with one method.  An effect whose size parameter is zero is
exactly the identity, so that adding one never changes a model before it is fitted.
"""

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Literal, TypeAlias

import equinox as eqx
from jaxtyping import Array, Float

from sysid.motion.motion import Motion

Stage = Literal["drive", "motion", "law", "force", "channel"]
FoundFrom = Literal["loops", "history", "check", "invisible"]
Family = Literal[
    "offset", "acquisition", "reactive", "gas_nonlinear", "timing", "friction", "lost_motion",
    "viscous", "rate_law", "thermal", "current_law", "run_history",
]  # fmt: skip
Parity = Literal["OD", "OC", "ED", "EC"]
Force: TypeAlias = Float[Array, "*batch n"]
Factor: TypeAlias = Float[Array, "..."] | float


@dataclass(frozen=True)
class Facts:
    """What is claimed of an effect; tests check every claim numerically.

    Attributes:
        id: Public name of the cause, never renamed.
        family: Group of kindred causes.
        found_from: "loops" (screened on steady loops), "history" (needs cycles, ramp, rest or run
            order), "check" (found from the channels themselves) or "invisible" (at constant
            current, because base parameters absorb it).
        size: Symbol of the parameter that is zero when the effect is absent.
        nominal: Symbol → a realistic value, SI.
        realistic: Symbol → (low, high) of what real dampers and rigs show, SI.
        parity: Half-wave and time-reversal symmetry of the added force that carries most of its
            energy, and the share it carries: OD, OC, ED or EC; None where it has no clear one.
        exponents: (p, q, r) of the RMS ∝ A^p f^q i^r, None where no power law holds.
        rivals: Ids of effects that look alike.
        separating_test: The test that tells them apart, for an engineer at the rig.
        source: Where the equation and the range come from.
        with_size: Symbols of other parameters that grow with the size where there is only more of
            the effect: a stiffness that friction builds up with, since half of the friction with
            the same stiffness builds up in half of the travel.
        of_temperature: It acts through what the temperatures of tests differ by, and cannot be seen
            where one of these is not known or all are the same.
    """

    id: str
    family: Family
    found_from: FoundFrom
    size: str
    nominal: dict[str, float]
    realistic: dict[str, tuple[float, float]]
    parity: tuple[Parity, float] | None
    exponents: tuple[float, float, float] | None
    rivals: tuple[str, ...]
    separating_test: str
    source: str
    with_size: tuple[str, ...] = ()
    of_temperature: bool = False

    @property
    def sign(self) -> int:
        """1 or −1 where the size has this sign in all real dampers and rigs, 0 where it has either.

        With the other sign a formula stands for something else, whose name it must not give.
        """
        low, high = self.realistic[self.size]
        return int(low > 0.0) - int(high < 0.0)


class Parts(eqx.Module):
    """A valve's force in two parts, N, [..., n] each; they add up to it, but for a gas beside them.

    Attributes:
        yielding: What the field makes: F(i) − F(0 A), unless the model knows better.
        viscous: What is left without field: F(0 A).
    """

    yielding: Force
    viscous: Force

    @property
    def total(self) -> Force:
        """The force, N."""
        return self.yielding + self.viscous


class Changes(eqx.Module):
    """What laws change in a valve, and what stands beside and before it; [..., n] or [..., 1] each.

    Attributes:
        yielding: Factor on the yield part.
        viscous: Factor on the viscous part.
        stiffness: Factor on the stiffness, which makes the loop narrower.
        leakage: Of leaks beside the valve, m/(s·N); None where there are none.
        compliance: Of a spring before valve and leaks, m/N; None where there is none.
    """

    yielding: Factor = 1.0
    viscous: Factor = 1.0
    stiffness: Factor = 1.0
    leakage: Factor | None = None
    compliance: Factor | None = None

    def also(self, more: "Changes") -> "Changes":
        """Both at once."""
        return Changes(
            self.yielding * more.yielding,
            self.viscous * more.viscous,
            self.stiffness * more.stiffness,
            _together(self.leakage, more.leakage),
            _together(self.compliance, more.compliance),
        )


def _together(one: Factor | None, other: Factor | None) -> Factor | None:
    if one is None or other is None:
        return other if one is None else one
    return one + other


@dataclass(frozen=True)
class ValveParts:
    """A valve's parts as a function of motion, and how laws change them.

    Attributes:
        parts: For any motion.
        inside: Parts of a valve that takes changes into its own equations, as one whose state
            depends on them must; None where factors on the parts say the same.
        thermal: The parts depend on temperature by the valve's own laws.
    """

    parts: Callable[[Motion], Parts]
    inside: Callable[[Motion, Changes], Parts] | None = None
    thermal: bool = False

    def __call__(self, motion: Motion) -> Parts:
        """The parts as they are."""
        return self.parts(motion)

    def changed(self, motion: Motion, changes: Changes, parts: Parts | None = None) -> Parts:
        """The parts with factors.

        A stiffness acts on the sign of acceleration, by which a valve without states knows the
        width of its loop.

        Args:
            motion: At the valve.
            changes: Factors.
            parts: Without a change, where they are known already.
        """
        if self.inside is not None:
            return self.inside(motion, changes)
        if not isinstance(changes.stiffness, float):
            narrow = motion.acceleration_sign / changes.stiffness
            parts = self.parts(eqx.tree_at(lambda m: m.acceleration_sign, motion, narrow))
        elif parts is None:
            parts = self.parts(motion)
        return Parts(
            yielding=parts.yielding * changes.yielding, viscous=parts.viscous * changes.viscous
        )


@dataclass(frozen=True)
class Behind:
    """Force of everything behind a motion effect, as a function of motion there.

    Attributes:
        force: N, for a motion.
        within: (velocity, force) for a motion whose velocity is taken to be that at the valve:
            leaks beside the valve take up more, and so the velocity behind the effect is known
            without solving for what they leave.
    """

    force: Callable[[Motion], Force]
    within: Callable[[Motion], tuple[Force, Force]]

    def __call__(self, motion: Motion) -> Force:
        """Force, N."""
        return self.force(motion)


class AbstractEffect(eqx.Module):
    """An effect: its parameters are declared with `sysid.parameters.param`."""

    facts: ClassVar[Facts]
    stage: ClassVar[Stage]


class AbstractDriveEffect(AbstractEffect):
    """Acts between commanded and effective current."""

    stage: ClassVar[Stage] = "drive"

    @abstractmethod
    def current(self, motion: Motion) -> Float[Array, "*batch c"]:
        """Effective current, A, from the commanded one in `motion`."""


class AbstractMotionEffect(AbstractEffect):
    """Acts between recorded motion and motion at the valve; may depend on the force."""

    stage: ClassVar[Stage] = "motion"

    @abstractmethod
    def at_valve(self, motion: Motion, force: Callable[[Motion], Force]) -> Motion:
        """Motion at the valve.

        Args:
            motion: As recorded.
            force: Force of everything behind this effect, for a motion at the valve, N.
        """

    def carried(self, force: Force, motion: Motion) -> Force:
        """Of the force behind this effect, N, what reaches its rig's side: all, unless it parts.

        Args:
            force: Of everything behind this effect, on the motion from `at_valve`, N.
            motion: On the rig's side.
        """
        return force


class AbstractLawEffect(AbstractEffect):
    """Changes how the valve's parts depend on frequency, temperature, speed or its own force."""

    stage: ClassVar[Stage] = "law"

    @abstractmethod
    def parts(self, motion: Motion, valve: ValveParts) -> Parts:
        """The valve's parts as changed.

        Args:
            motion: At the valve.
            valve: The parts without this effect, for any motion, and with factors.
        """

    def leakage(self, motion: Motion) -> Float[Array, "..."] | None:
        """Of a leak beside the valve, w = v − k F(w), its k, m/(s·N), whatever the velocity.

        None where this is no leak.  Leaks lie outside of all other laws, beside each other.

        Args:
            motion: At the valve and its leaks.
        """
        return None


class AbstractForceEffect(AbstractEffect):
    """A force in parallel to the valve."""

    stage: ClassVar[Stage] = "force"

    @abstractmethod
    def force(self, motion: Motion) -> Force:
        """Added force, N, positive when it resists compression; `motion` is that at the valve."""


class AbstractChannelEffect(AbstractEffect):
    """Acts between true and recorded force."""

    stage: ClassVar[Stage] = "channel"

    @abstractmethod
    def recorded(self, force: Force, motion: Motion) -> Force:
        """Recorded force, N; `motion` is the recorded one."""
