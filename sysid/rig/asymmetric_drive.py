"""A current that is made to follow the direction of motion, and a coil that is late.

It shares no code with `sysid.isolator.asymmetric_current` and `sysid.effects`, so that an error in
either shows as a difference between them.
"""

from dataclasses import dataclass
from itertools import accumulate
from typing import Final

import numpy as np
from jaxtyping import Float

from sysid.rig.arctangent import angle
from sysid.rig.elementary import exp
from sysid.rig.excitation import SineRun, State

Samples = Float[np.ndarray, " n"]

_PI: Final = 3.141592653589793
_STEPS: Final = 20
"""Of the coil in one sample of the recorder."""


@dataclass(frozen=True)
class AsymmetricDrive:
    """What stands between the commanded current and the field.

    Attributes:
        compression: p, current in compression over that in rebound.
        smoothing: ζ.
        lag: Time constant of the coil, s.

    Source:
        W11 Eqs. 1 and 2 (`papers/reading.md`: p in compression, 1 in rebound).
    """

    compression: float
    smoothing: float
    lag: float

    def asked(self, state: State) -> Samples:
        """M_p, the part of the command that the controller asks for, [n].

            M_p = m + (e − m) (2/π) arctan(ζ |v| / v_m),   m = (1 + p)/2

        with the end e = p in compression and 1 in rebound; m at rest.
        """
        middle = 0.5 * (1.0 + self.compression)
        end = np.where(state.velocity > 0.0, self.compression, 1.0)
        turned = angle(self.smoothing * np.abs(state.velocity), state.peak_velocity)
        return middle + (end - middle) * (2.0 / _PI * turned)

    def current(self, run: SineRun, first: float, count: int, rate: int, command: float) -> Samples:
        """Current in the coil, [count] A: τ di/dt = M_p i_c − i, from rest.

        Between steps of a twentieth of a sample M_p is taken as straight, and the lag is exact.

        Args:
            run: Motion of the piston.
            first: Time of the first sample, s; the coil is at rest then.
            count: Samples.
            rate: Of the samples, Hz.
            command: i_c, A.
        """
        steps = _STEPS * rate
        time = first + np.arange(_STEPS * (count - 1) + 1) / steps
        asked = command * self.asked(run.state(time))
        kept = float(exp(np.asarray(-1.0 / (steps * self.lag))))
        mean = steps * self.lag * (1.0 - kept)
        driven = (1.0 - mean) * asked[1:] + (mean - kept) * asked[:-1]
        course = accumulate(driven.tolist(), lambda i, d: kept * i + d, initial=float(asked[0]))
        return np.array(list(course))[::_STEPS]
