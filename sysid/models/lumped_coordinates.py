"""Solver coordinates of the lumped model."""

from typing import Final, Literal, get_args

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from sysid.arrays import Scalar
from sysid.effects.reference_temperature import REFERENCE
from sysid.errors import FitError
from sysid.models.coordinates import AbstractCoordinates, Reference, positive, unpositive
from sysid.models.levels import Levels
from sysid.models.lumped import TABLE_1, Lumped
from sysid.parameters import specs

LumpedVariant = Literal["paper", "full"]
LUMPED_VARIANTS: Final[tuple[LumpedVariant, ...]] = get_args(LumpedVariant)

_STIFF: Final = 50.0
"""Force over stiffness is some 2 % of the travel; likewise a yield velocity of that speed."""
_INERT: Final = 0.05
"""Part of the force that accelerating the fluid to full speed within the travel takes."""

Ends = Float[Array, "ends *table"]


class LumpedCoordinates(AbstractCoordinates[Lumped]):
    r"""Value-type coordinates of the lumped model.

    Every straight line in temperature is given by its values at the campaign's coldest and warmest
    temperature, which are positive and known about equally well.  With N, V, L the campaign's
    reference force, speed and length, and I currents, the coordinates are, at each of both ends,

        log kL/50N    I × C_post V/N (softplus)    I × F_y/N (softplus)

    and in the variant "full" log C_pre V/50N and log 20 m_l V²/NL.  In the variant "paper" C_pre =
    100 kN·s/m and m_l = 2 kg, as the source has them; the lag of the current is 3 ms in both, since
    a constant current does not show it.  Where the campaign has one temperature, there is one end,
    and all slopes are held at zero.

    Attributes:
        reference: The campaign's magnitudes.
        cold: °C.
        warm: °C.
        currents: A, of the tables.
        sloped: There are two temperatures.
        variant: "paper" or "full".
    """

    reference: Reference
    cold: Scalar
    warm: Scalar
    currents: tuple[float, ...] = eqx.field(static=True)
    sloped: bool = eqx.field(static=True)
    variant: LumpedVariant = eqx.field(static=True)

    @property
    def size(self) -> int:
        """How many coordinates are free."""
        return len(self.free)

    @property
    def free(self) -> tuple[str, ...]:
        """All but the lag, in "paper" C_pre and m_l, and slopes where there is one temperature."""
        declared = [s.symbol for s in specs(Lumped, {"currents": self.currents})]
        return tuple(s for s in declared if s not in self._held(declared))

    @property
    def ties(self) -> tuple[tuple[str, str], ...]:
        """None."""
        return ()

    @property
    def statics_free(self) -> bool:
        """The gas of the accumulator, which the source takes away before it reads F_y."""
        return True

    @property
    def remarks(self) -> tuple[str, ...]:
        """What is held, and why."""
        told = ["tau is held at 3 ms: tests at constant current do not show it."]
        if self.variant == "paper":
            told = ["C_pre, m_l and tau are held at 100 kN·s/m, 2 kg and 3 ms, as published."]
        if not self.sloped:
            told.append(
                "The tests have one temperature, or none that is known: how the damper changes "
                "with temperature is not determined, and all slopes are held at zero."
            )
        return tuple(told)

    def valve(self, u: Float[Array, " n"]) -> Lumped:
        """The model at u."""
        N, V, L = self.reference.force, self.reference.speed, self.reference.length
        ends, count = 2 if self.sloped else 1, len(self.currents)
        k, rest = u[:ends], u[ends:]
        post, yielding = rest[: 2 * ends * count].reshape(2, ends, count)
        more = rest[2 * ends * count :]
        full = self.variant == "full"
        k_intercept, k_slope = self._line(jnp.exp(k) * _STIFF * N / L)
        C_intercept, C_slope = self._line(positive(post) * N / V)
        F_intercept, F_slope = self._line(positive(yielding) * N)
        return Lumped(
            currents=self.currents,
            C_pre=jnp.exp(more[0]) * _STIFF * N / V if full else jnp.asarray(TABLE_1["C_pre"]),
            m_l=jnp.exp(more[1]) * _INERT * N * L / V**2 if full else jnp.asarray(TABLE_1["m_l"]),
            tau=jnp.asarray(TABLE_1["tau"]),
            k_intercept=k_intercept,
            k_slope=k_slope,
            C_post_intercept=C_intercept,
            C_post_slope=C_slope,
            F_y_intercept=F_intercept,
            F_y_slope=F_slope,
        )

    def locate(self, valve: Lumped) -> Float[Array, " n"]:
        """Coordinates of a model with the same currents; values of zero are moved just inside."""
        N, V, L = self.reference.force, self.reference.speed, self.reference.length
        m = valve
        more = []
        if self.variant == "full":
            more = [jnp.log(m.C_pre * V / (_STIFF * N)), jnp.log(m.m_l * V**2 / (_INERT * N * L))]
        k = self._ends(m.k_intercept, m.k_slope) * L / (_STIFF * N)
        return jnp.concatenate([
            jnp.log(jnp.maximum(k, 1e-4)),
            unpositive(self._ends(m.C_post_intercept, m.C_post_slope) * V / N).ravel(),
            unpositive(self._ends(m.F_y_intercept, m.F_y_slope) / N).ravel(),
            jnp.array(more),
        ])  # fmt: skip

    def _held(self, declared: list[str]) -> set[str]:
        held = {"tau"} if self.variant == "full" else {"tau", "C_pre", "m_l"}
        return held if self.sloped else held | {s for s in declared if s.endswith(".slope")}

    def _line(self, ends: Ends) -> tuple[Float[Array, "*table"], Float[Array, "*table"]]:
        """Intercept at 0 °C and slope."""
        if not self.sloped:
            return ends[0], jnp.zeros_like(ends[0])
        slope = (ends[1] - ends[0]) / (self.warm - self.cold)
        return ends[0] - slope * self.cold, slope

    def _ends(self, intercept: Float[Array, "*table"], slope: Float[Array, "*table"]) -> Ends:
        at = (self.cold, self.warm) if self.sloped else (self.cold,)
        return jnp.stack([intercept + slope * t for t in at])


def lumped_coordinates(
    reference: Reference, levels: Levels, variant: LumpedVariant
) -> LumpedCoordinates:
    """Coordinates for a campaign.

    Args:
        reference: Its magnitudes.
        levels: Its currents and temperatures.
        variant: "paper" or "full".

    Raises:
        FitError: Some tests know their temperature and some do not.
    """
    if 0 < levels.untold < levels.tests:
        raise FitError(
            f"{levels.untold} of {levels.tests} tests have no temperature",
            advice="The lumped model's numbers are lines in temperature: give it as a column, in "
            "tests.csv or in the file name, or leave these tests out with --exclude",
        )
    cold, warm = levels.temperatures or (REFERENCE, REFERENCE)
    if not levels.warmed:
        cold = warm = 0.5 * (cold + warm)
    return LumpedCoordinates(
        reference, jnp.asarray(cold), jnp.asarray(warm), levels.currents, levels.warmed, variant
    )
