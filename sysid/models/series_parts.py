"""The parts of valves with hysteresis, with laws, leaks and a spring in their own equations."""

from typing import NamedTuple, TypeAlias

import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.effects.base import Changes, Parts
from sysid.models.internal_state import follow
from sysid.models.series_state import Followed, SeriesElement, follow_in_series
from sysid.motion.motion import Motion

Number: TypeAlias = Float[Array, "..."]


class ByCurrent(NamedTuple):
    """A number of the valve in two parts, which add up to it.

    Attributes:
        idle: At 0 A.
        field: What the field adds.
    """

    idle: Number
    field: Number

    def changed(self, changes: Changes) -> "ByCurrent":
        """Each times the factor on the part of the force that it makes."""
        return ByCurrent(self.idle * changes.viscous, self.field * changes.yielding)

    @property
    def whole(self) -> Number:
        """Both."""
        return self.idle + self.field


class SeriesLaw(NamedTuple):
    """What a valve with hysteresis is made of, SI.

    Attributes:
        yielding: α.
        inner: c_0, beside it.
        outer: c_1, in series with both; None where there is none.
        stiffness: k_0, beside them; None where the place of the element does not matter.
        rho: ρ.
        sigma: σ of Bouc and Wen's state; None for Dahl's.
        beside: k_1, beside all that.
        constant: f_0.
    """

    yielding: ByCurrent
    inner: ByCurrent
    outer: ByCurrent | None
    stiffness: Number | None
    rho: Number
    sigma: Number | None
    beside: Number
    constant: Number


def parts_in_series(law: SeriesLaw, motion: Motion, changes: Changes) -> Parts:
    r"""The parts of the force as laws, leaks and a spring change the valve, N.

        F = F' + k_1 x_v + f_0,    F' = α w + c_0 u̇ + k_0 u,    x_v = x − s F
        u̇ = ẋ_v − F'/c_1 − κ F'

    with the leak κ beside the valve alone: what k_1 and f_0 stand for is no flow through it.
    Factors act on α, c_0 and c_1, that of the yield part on what the field adds to them, and one
    on stiffness on ρ, 1/ρ being the travel in which the force builds up.  The yield part of F' is
    what the field adds to α w + c_0 u̇.  Where nothing gives way, w
    follows the piston itself, by as exact a flow.

    Args:
        law: Of the valve.
        motion: Ahead of the spring.
        changes: Of the valve's numbers.
    """
    element = element_of(law, changes)
    if law.outer is None and not _gives_way(changes):
        flow, path = element.flow(element.rho), motion.path
        w = follow(flow, path, periodic=motion.periodic)
        return parts_at(law, motion, changes, Followed(path, w, motion.velocity, ()))
    return parts_at(law, motion, changes, follow_in_series(element, motion))


def element_of(law: SeriesLaw, changes: Changes) -> SeriesElement:
    """The element of a valve with changes.

    Args:
        law: Of the valve.
        changes: Of its numbers.
    """
    mobility = jnp.zeros(())
    if law.outer is not None:
        mobility = 1.0 / law.outer.changed(changes).whole
    if changes.leakage is not None:
        mobility = mobility + changes.leakage
    follows = _follows(law, changes)
    return SeriesElement(
        yielding=law.yielding.changed(changes).whole,
        inner=law.inner.changed(changes).whole,
        mobility=mobility,
        stiffness=law.stiffness,
        rho=law.rho * changes.stiffness,
        sigma=law.sigma,
        follows=follows,
        compliance=None if changes.compliance is None else changes.compliance * follows,
    )


def parts_at(law: SeriesLaw, motion: Motion, changes: Changes, at: Followed) -> Parts:
    """The parts of the force with a state of the element that is known, N.

    Args:
        law: Of the valve.
        motion: Ahead of the spring.
        changes: Of the valve's numbers.
        at: State.
    """
    alpha, inner = law.yielding.changed(changes), law.inner.changed(changes)
    yielding = alpha.field * at.state + inner.field * at.rate
    through = alpha.idle * at.state + inner.idle * at.rate
    if law.stiffness is not None:
        through = through + law.stiffness * at.travel
    gas = law.beside * motion.displacement + law.constant
    if changes.compliance is not None:
        # k_1 x_v, from F = (F' + k_1 x + f_0) / (1 + k_1 s)
        whole = _follows(law, changes) * (yielding + through + gas)
        gas = gas - law.beside * changes.compliance * whole
    return Parts(yielding=yielding, viscous=through + gas)


def _follows(law: SeriesLaw, changes: Changes) -> Number | float:
    return 1.0 if changes.compliance is None else 1.0 / (1.0 + law.beside * changes.compliance)


def _gives_way(changes: Changes) -> bool:
    """Or has another ρ, which need not be the same in all tests and at all times."""
    stiffer = not isinstance(changes.stiffness, float) or changes.stiffness != 1.0
    return stiffer or changes.leakage is not None or changes.compliance is not None
