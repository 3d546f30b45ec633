"""How far the motion is from a sine wave."""

from typing import Final

import numpy as np

from sysid.data.harmonics import ORDER
from sysid.data.quality.fault import Fault, graded
from sysid.data.quality.subject import Subject

SIZE: Final = (0.01, 0.05)
"""RMS of the harmonics over that of the fundamental from which on it is a note, and a warning."""


def check_waveform(subject: Subject) -> list[Fault]:
    """Harmonics 2 to 15 of the displacement, as far as noise does not explain them.

    Nothing here takes the motion for a sine, but v_m = Aω of the generalised model is that of the
    fundamental, and nominal velocities are not those of such a test.
    """
    loop = subject.loop
    if loop is None:
        return []
    lines = np.abs(np.fft.rfft(loop.displacement)[1 : ORDER + 1])
    if not lines[0] > 0.0:
        return []
    shares = lines[1:] / lines[0]
    size = float(np.sqrt(np.sum(shares**2)))
    most = int(np.argmax(shares))
    text = (
        f"the motion is no pure sine: its harmonics hold {100 * size:.1f} % of the fundamental, "
        f"most of it the {_ordinal(most + 2)} with {100 * shares[most]:.1f} %"
    )
    return graded("waveform_distortion", size, *SIZE, text)


def _ordinal(number: int) -> str:
    return f"{number}{ {2: 'nd', 3: 'rd'}.get(number, 'th') }"
