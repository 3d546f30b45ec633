"""Bands of loops in `fit.json`, and in sentences."""

from typing import Any, Final

import numpy as np

from sysid.report.fit_json import known
from sysid.uncertainty.bands import Band
from sysid.uncertainty.conformal import conditions_needed
from sysid.uncertainty.loop_bands import LoopBands
from sysid.uncertainty.quantities import QUANTITIES

KEYS: Final = ("dissipated_energy_J", "peak_force_N", "standstill_half_height_N")
"""Of `QUANTITIES`, in their order."""
assert len(KEYS) == len(QUANTITIES)


def bands_json(bands: LoopBands) -> dict[str, Any]:
    """What `fit.json` holds of the bands."""
    whole, widths = bands.whole_inside, {k: bands.half_width(b) for k, b in bands.forces.items()}
    if bands.conformal_band is not None:
        widths |= {"conformal": bands.half_width(bands.conformal_band)}
    inside = bands.inside
    tests = [
        {
            "id": name,
            "held_out": bool(bands.held_out[k]),
            "extrapolated_in": bands.outside[k] or None,
            "mean_half_width_N": {kind: float(width[k]) for kind, width in widths.items()},
            "inside_recorded": float(inside[k]),
            "whole_inside_conformal": None if whole is None else bool(whole[k]),
            **{key: _ends(b, k) for key, b in zip(KEYS, bands.quantities, strict=True)},
        }
        for k, name in enumerate(bands.ids)
    ]
    scores = bands.conformal
    return {
        "level": next(iter(bands.forces.values())).level,
        "draws": bands.draws,
        "not_known": dict(bands.unknown),
        "conformal": {
            "level": scores.level,
            "conditions": len(scores.u),
            "conditions_needed": conditions_needed(scores.level),
            "score": known(scores.score),
            "says": scores.words,
        },
        "tests": tests,
        "sentences": list(band_sentences(bands)),
    }


def _ends(band: Band, k: int) -> dict[str, float | None]:
    ends = {"value": band.middle, "low": band.low, "high": band.high}
    return {name: known(float(values[k])) for name, values in ends.items()}


def band_sentences(bands: LoopBands) -> tuple[str, ...]:
    """How wide the bands are, and how many measured points lie in them."""
    peak = np.abs(bands.measured).max(axis=1)
    told = {
        kind: float(np.median(bands.half_width(band) / peak)) for kind, band in bands.forces.items()
    }
    words = f"95 % bands, median over tests in parts of max|F|: ± {told['parameters']:.2%} by the "
    words += "parameters"
    if "laws" in told:
        words += f", ± {told['laws']:.2%} with errors of the laws given the residuals"
    words += f", ± {told['recorded']:.2%} for what a new test would record"
    if "laws" not in told:
        words += ", with all that the model leaves taken for noise"
    found = [words]
    if bands.statics_free:
        found.append(
            "Bands are of the force apart from a static force of each test, which the model leaves "
            "free"
        )
    inside = bands.inside
    for name, which in (("fitted", ~bands.held_out), ("held-out", bands.held_out)):
        if which.any():
            found.append(
                f"Of the points of {name} tests {np.mean(inside[which]):.1%} lie within the last"
            )
    away = sum(bool(z) for z in bands.outside)
    if away and "laws" in told:
        found.append(
            f"Outside of the ranges that were fitted lie {away} of {len(bands.ids)} tests: errors "
            "of the laws are extrapolated there, and nothing measured vouches for their size"
        )
    found += bands.unknown.values()
    found.append(_of_conformal(bands, peak))
    return tuple(found)


def _of_conformal(bands: LoopBands, peak: np.ndarray) -> str:
    words = bands.conformal.words
    if bands.conformal_band is None:
        return words[0].upper() + words[1:]
    width = float(np.median(bands.half_width(bands.conformal_band) / peak))
    return f"Without any likelihood, from tests left out: ± {width:.2%}; {words}"
