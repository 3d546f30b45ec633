"""Oil that is warmer than the body where the thermometer sits."""

from typing import ClassVar

from sysid.arrays import Scalar
from sysid.effects.base import AbstractLawEffect, Changes, Facts, Parts, ValveParts
from sysid.effects.oil_heat import mean_power, thinning, warmer
from sysid.motion.motion import Motion
from sysid.parameters import param


class SurfaceTemperature(AbstractLawEffect):
    r"""The heat of the oil flows out through the body, which is colder.

        T_oil = T_b + R_th P,   F_visc ← F_visc exp(−0.5 %/K · R_th P)

    P is the mean of F v over the test, of the valve at T_b.  The force falls in proportion to power
    as if speed and current weakened it.  Forces show only the product of R_th and the loss of
    viscosity per kelvin, which is 0.5 % here.  T_b is the recorded temperature; a law of
    temperature on it is an effect of its own.

    A valve that has laws of temperature itself is read at T_oil instead, all of it, and R_th is
    that of the damper.  A thermometer on the oil that lags by t_l shows the same: while a test
    heats by P/(m c) a second, the oil is ahead by t_l P/(m c).

    Source:
        Steady heat flow from oil to body, 2–10 K; BS09 Table 1 (C_post).
    """

    facts: ClassVar[Facts] = Facts(
        id="surface_temperature",
        family="thermal",
        found_from="history",
        size="R_th",
        nominal={"R_th": 0.1},
        realistic={"R_th": (0.01, 0.5)},
        parity=("OD", 0.98),
        exponents=(1.81, 1.77, 0.37),
        rivals=("viscosity_temperature", "self_heating"),
        separating_test="dwell at each test until the temperature of the body is steady",
        source="steady heat flow from oil to body, BS09 Table 1",
    )
    R_th: Scalar = param(
        symbol="R_th", name="thermal resistance from oil to body", unit="K/W", typical=0.1, low=0.0
    )

    def parts(self, motion: Motion, valve: ValveParts) -> Parts:
        """The parts in oil that is warmer than the body."""
        parts = valve(motion)
        rise = self.R_th * mean_power(motion, parts.total)
        if valve.thermal:
            return valve(warmer(motion, rise))
        return valve.changed(motion, Changes(viscous=thinning(rise)), parts)
