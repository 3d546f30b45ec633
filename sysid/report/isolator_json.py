"""A card in an isolator, for scripts."""

import math
from typing import Any

import numpy as np

from sysid.isolator.card_study import CardStudy, Drawn
from sysid.isolator.compare import LEVEL, Band, Change, Rival
from sysid.isolator.study import ConflictDiagram, Curve

SCHEMA = "sysid-isolator-1"


def isolator_json(study: CardStudy) -> dict[str, Any]:
    """All of a study but single runs; changes are parts, not per cent."""
    ends = sorted({0, len(study.temperatures) - 1})
    return {
        "schema": SCHEMA,
        "plant": study.order.plant,
        "base_motion": study.diagram.motion,
        "motions": study.order.motions,
        "seed": study.order.seed,
        "runs": study.diagram.runs,
        "temperatures_degC": list(study.temperatures),
        "gains": _gains(study),
        "controllers": [_curve(c) for c in study.diagram.curves],
        "passive": _curve(study.passive),
        "ideal_skyhook": None if study.ideal is None else _curve(study.ideal),
        "cold_to_warm": [_change(c) for c in study.changes],
        "draws": {
            "count": study.drawn[0].acceleration.shape[2] if study.drawn else 0,
            "from": study.drawn_from or None,
            "controllers": [_drawn(d) for d in study.drawn],
        },
        "cold_to_warm_over_draws": [
            {"controller": d.name, "acceleration": _over_draws(d.changes[0]),
             "working_space": _over_draws(d.changes[1])}
            for d in study.drawn
            if d.changes
        ],
        "laws": {case: [_change(c) for c in changes] for case, changes in study.laws.items()},
        "equal_working_space": [
            _rival(r, study.temperatures[end])
            for end, rivals in zip(ends, study.rivals, strict=True)
            for r in rivals
        ],
        "rig": None if study.rig is None else _rig(study, study.rig, ends),
        "share_beyond_tested_speed": study.beyond,
        "tested_speed_m/s": study.fastest,
        "left_out": list(study.left_out),
        "trusted": study.trusted,
    }  # fmt: skip


def _gains(study: CardStudy) -> dict[str, Any]:
    gains, found = study.gains, study.ultimate
    return {
        "B": gains.feedback,
        "G_A/N": gains.feedforward,
        "K_p_A/N": gains.pid[0],
        "K_i_A/(N s)": gains.pid[1],
        "K_d_A s/N": gains.pid[2],
        "table_speed_m/s": gains.speed,
        "table_temperature_degC": gains.temperature,
        "ultimate_gain_A/N": None if found is None else found.gain,
        "ultimate_period_s": None if found is None else found.period,
    }


def _rig(study: CardStudy, rig: ConflictDiagram, ends: list[int]) -> dict[str, Any]:
    return {
        "temperatures_degC": [study.temperatures[k] for k in ends],
        "controllers": [_curve(c) for c in rig.curves],
        "equal_working_space": [
            _rival(r, study.temperatures[end])
            for end, rivals in zip(ends, study.rig_rivals, strict=True)
            for r in rivals
        ],
    }


def _curve(curve: Curve) -> dict[str, Any]:
    """Means over motions, [set points][variants]; null where a run ran away."""
    return {
        "controller": curve.name,
        "set_points": list(curve.set_points),
        "set_point_unit": curve.unit,
        "rms_acceleration_m/s2": _listed(curve.acceleration.mean(axis=2)),
        "rms_acceleration_sd_over_motions_m/s2": _listed(curve.acceleration.std(axis=2)),
        "rms_working_space_m": _listed(curve.working_space.mean(axis=2)),
        "rms_working_space_sd_over_motions_m": _listed(curve.working_space.std(axis=2)),
        "largest_piston_speed_m/s": _listed(curve.piston_speed.mean(axis=2)),
        "rms_current_A": _listed(curve.current.mean(axis=2)),
        "rms_tyre_deflection_m": _listed(curve.tyre.mean(axis=2)),
    }


def _drawn(drawn: Drawn) -> dict[str, Any]:
    """Over the card's own, less 1: quantiles, [set points][ends]; null where a run ran away."""
    quantiles = {"low": 0.5 - LEVEL / 2, "median": 0.5, "high": 0.5 + LEVEL / 2}

    def spread(ratios: np.ndarray) -> dict[str, Any]:
        found = {n: np.quantile(ratios, q, axis=2) - 1.0 for n, q in quantiles.items()}
        return {n: _listed(rows) for n, rows in found.items()}

    return {
        "controller": drawn.name,
        "set_points": list(drawn.set_points),
        "set_point_unit": drawn.unit,
        "rms_acceleration": spread(drawn.acceleration),
        "rms_working_space": spread(drawn.working_space),
        "level": LEVEL,
    }


def _change(change: Change) -> dict[str, Any]:
    return {
        "controller": change.name,
        "set_point": change.set_point,
        "acceleration": _band(change.acceleration),
        "working_space": _band(change.working_space),
    }


def _rival(rival: Rival, temperature: float) -> dict[str, Any]:
    return {
        "controller": rival.name,
        "over": rival.over,
        "temperature_degC": temperature,
        "acceleration_excess": _band(rival.excess),
        "working_space_m": list(rival.spaces),
    }


def _band(band: Band) -> dict[str, Any]:
    return {
        "value": _finite(band.value),
        "low": _finite(band.low),
        "high": _finite(band.high),
        "level": LEVEL,
        "single_motion_low": _finite(band.single_low),
        "single_motion_high": _finite(band.single_high),
    }


def _over_draws(band: Band) -> dict[str, Any]:
    ends = (band.value, band.single_low, band.single_high)
    return dict(zip(("value", "low", "high"), map(_finite, ends), strict=True)) | {"level": LEVEL}


def _listed(rows: np.ndarray) -> list[list[float | None]]:
    return [[_finite(z) for z in row] for row in rows.tolist()]


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
