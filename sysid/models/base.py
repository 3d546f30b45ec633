"""What every model of a damper is, and every valve model."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.effects.base import Changes, Force, Parts
from sysid.motion.motion import Motion


class AbstractModel(eqx.Module):
    """Force from motion, current and temperature."""

    @abstractmethod
    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """Force at every point of the motion, N, positive when it resists compression."""


@dataclass(frozen=True)
class Laws:
    """Attributes of a valve that, all times one factor, put that factor on one of its laws.

    Attributes:
        width: Of the loop about standstill.
        steepness: Of the step that the force makes there.
        growth: Of the force with speed beyond the step.
        yielding: Of the yield force alone, where the valve has a law of its own for it.
    """

    width: tuple[str, ...] = ()
    steepness: tuple[str, ...] = ()
    growth: tuple[str, ...] = ()
    yielding: tuple[str, ...] = ()

    @property
    def bent(self) -> tuple[tuple[str, ...], ...]:
        """Those that change the shape of a loop: width, steepness, growth."""
        return self.width, self.steepness, self.growth


class AbstractValve(AbstractModel):
    """A damper's valve, whose force has a yield part and a viscous part.

    Some models have a gas force, k x + f_0, in parallel as well.  It drives no oil through the
    valve, so laws and leaks act on the parts alone:

        F = F_yield + F_viscous + F_gas

    Attributes:
        laws: What scales each of them; for the directions in which a valve may be wrong.
        thermal: Its force depends on temperature, as at 40 °C where that is not known.
        memoryless: Its force follows from the instant alone, so that it can be asked for at any
            velocity without the motion before.
    """

    laws: ClassVar[Laws]
    thermal: ClassVar[bool] = False
    memoryless: ClassVar[bool] = False

    @abstractmethod
    def parts(self, motion: Motion) -> Parts:
        """The force as a yield part and a viscous part, without `gas_force`."""

    def gas_force(self, motion: Motion) -> Force | None:
        """Of the gas beside the valve, N; None where no gas stands beside the parts."""
        return None

    def without_gas(self, motion: Motion) -> Force:
        """The force but for `gas_force`, N: the sum of the parts."""
        return self.force(motion)


class AbstractInnerValve(AbstractValve):
    """A valve that takes changes into its own equations.

    Around any other valve laws are factors on its parts, leaks are found pointwise in time, and
    springs are solved for.  None of that is right where the parts follow from a state, which goes
    by the motion that leaks and springs leave.  A gas stands in these equations, too, where no
    factor and no leak reaches it: it has no `gas_force`.
    """

    @abstractmethod
    def parts_changed(self, motion: Motion, changes: Changes) -> Parts:
        """The parts of the valve as laws, leaks and a spring change it, N.

        Args:
            motion: Ahead of the spring and leaks.
            changes: Of the valve's numbers.
        """


def parts_by_current(valve: AbstractValve, motion: Motion) -> Parts:
    """Yield part F(i) − F(0 A), viscous part F(0 A): for models that do not know better.

    F is the force without gas.
    """
    idle = eqx.tree_at(lambda m: m.current, motion, jnp.zeros_like(motion.current))
    viscous = valve.without_gas(idle)
    return Parts(yielding=valve.without_gas(motion) - viscous, viscous=viscous)
