"""W11's asymmetric current on its symmetric damper: which ratio of rebound to compression."""

from typing import Final

import numpy as np
from outcome import Outcome, arguments

from sysid.effects.drive.coil_lag import CoilLag
from sysid.effects.registry import make
from sysid.isolator.asymmetric_current import Asymmetry, Ratios, asymmetric_sines, ratios_of
from sysid.models.damper import Damper
from sysid.models.generalized import ASYMMETRIC, LOW_SYMMETRIC, Generalized
from sysid.motion.motion import Motion, sine_motion
from sysid.parameters import build

AMPLITUDE: Final = 0.0125
FREQUENCIES: Final = (0.5, 1.5, 2.5, 5.0)
PUBLISHED: Final = (0.5, 1.5, 2.5)
"""Hz, where Table 3 may be trusted at 12.5 mm."""
CURRENTS: Final = (0.0, 0.1, 0.2, 0.3)
SMOOTHING: Final = (2.0, 10.0, 1e6)
LAGS: Final = (0.003, 0.01, 0.025)


def main() -> None:
    _, quick = arguments(__doc__ or "", 1, 1)
    outcome = Outcome("asymmetric_current", "W11's asymmetric current (ADFG)")
    valve = Damper(build(Generalized, LOW_SYMMETRIC))
    rows, numbers = [], []
    for smoothing in SMOOTHING:
        asymmetry = Asymmetry(0.0, smoothing)
        motion = asymmetric_sines(asymmetry, AMPLITUDE, list(FREQUENCIES), [0.3])
        for lag in LAGS:
            found = ratios_of(valve.with_effect(make(CoilLag, lag)), motion)
            rows.append((f"{smoothing:g}", f"{1e3 * lag:g}", *_cells(found)))
            numbers.append({"zeta": smoothing, "lag_s": lag, "ratio": found.at_peak.tolist()})
    outcome.say(
        "|F(−v_m)| / F(v_m) of the symmetric damper (Table 2, low set) at 12.5 mm, 0.3 A, p = 0,",
        "behind a coil's lag.  W11 tells 4 at low and 2 at high speed, with ζ = 2.",
    )
    head = ("ζ", "lag, ms", *(f"{f:g} Hz" for f in FREQUENCIES))
    outcome.table(head, rows)
    outcome.numbers["modulated"] = numbers
    outcome.say("The same of the published asymmetric model (Table 3), current by current:")
    published = build(Generalized, ASYMMETRIC)
    of_current = {i: ratios_of(published, _sines(i)) for i in CURRENTS}
    outcome.table(
        ("A", *(f"{f:g} Hz" for f in PUBLISHED)),
        [(f"{i:g}", *_cells(found)) for i, found in of_current.items()],
    )
    outcome.numbers["published"] = {f"{i:g}": r.at_peak.tolist() for i, r in of_current.items()}
    outcome.finish(keep=not quick)


def _sines(current: float) -> Motion:
    return sine_motion(AMPLITUDE, np.array(PUBLISHED), current)


def _cells(found: Ratios) -> list[str]:
    return [f"{z:.2f}" for z in found.at_peak]


if __name__ == "__main__":
    main()
