"""What the data determine, in `fit.json`."""

from typing import Any

from sysid.report.fit_json import known
from sysid.uncertainty.identifiability import Identifiability


def identifiability_json(found: Identifiability, likelihood: str) -> dict[str, Any]:
    """Spectrum, profiles with their ends, and quantities that are known.

    Args:
        found: Under a likelihood.
        likelihood: Its name.
    """
    return {
        "likelihood": likelihood,
        "spectrum": found.spectrum.tolist(),
        "profiles": {
            p.symbol: {
                "best": p.best,
                "low": known(p.low),
                "high": known(p.high),
                "closed": [bool(z) for z in p.closed],
            }
            for p in found.profiles
        },
        "known": [vars(k) for k in found.known],
        "sentences": list(found.sentences),
    }
