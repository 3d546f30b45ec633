"""How a damper is brought to the temperature of its next test: worked warm, or cooled by water."""

from dataclasses import dataclass
from typing import Final

from sysid.rig.physical.heat import HeatBalance

STEP: Final = 0.25
"""s; the balance's own times are tens of seconds and more."""
PATIENCE: Final = 4000.0
"""s, after which the operator takes the temperature that there is."""


@dataclass(frozen=True)
class Operator:
    """What happens between two tests.

    Attributes:
        power: Heat set free while the damper is worked warm, W; about that of 5 mm 4 Hz 0.25 A.
        coolant: Temperature of water in tubes round the body, or of moved air, °C.
        cooling: Body to coolant, W/K.
        scatter: Standard deviation of the body's temperature about what was wanted, K.
        window: Farthest that a test may start from it, K.

    Source:
        BS09 section 2: warmed by 5 mm 4 Hz at 0.25 A, cooled by copper tubing to about 11 °C.
        W11 section 2.1: data taken at 40 ± 10 °C.
    """

    power: float
    coolant: float = 8.0
    cooling: float = 12.0
    scatter: float = 0.8
    window: float = 10.0

    def bring(
        self, heat: HeatBalance, oil: float, body: float, wanted: float
    ) -> tuple[float, float]:
        """Oil and body, °C, when the thermocouple on the body first shows what is wanted."""
        warm = wanted > body
        for _ in range(round(PATIENCE / STEP)):
            if (body >= wanted) if warm else (body <= wanted):
                break
            power = self.power if warm else 0.0
            taken = 0.0 if warm else self.cooling * (body - self.coolant)
            passed = heat.inner * (oil - body)
            lost = heat.outer * (body - heat.room) + taken
            oil += STEP * (power - passed) / heat.oil
            body += STEP * (passed - lost) / heat.body
        return float(oil), float(body)
