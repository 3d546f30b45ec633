"""A card in an isolator, for scripts."""

import math
from typing import Any

from sysid.isolator.card_study import CardStudy
from sysid.isolator.compare import Band, Change, Rival
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
        "cold_to_warm_over_draws": [
            {"controller": d.name, "acceleration": _over_draws(d.acceleration),
             "working_space": _over_draws(d.working_space)}
            for d in study.drawn
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
    """Means over motions, [set points][variants]."""
    return {
        "controller": curve.name,
        "set_points": list(curve.set_points),
        "set_point_unit": curve.unit,
        "rms_acceleration_m/s2": curve.acceleration.mean(axis=2).tolist(),
        "rms_acceleration_sd_over_motions_m/s2": curve.acceleration.std(axis=2).tolist(),
        "rms_working_space_m": curve.working_space.mean(axis=2).tolist(),
        "rms_working_space_sd_over_motions_m": curve.working_space.std(axis=2).tolist(),
        "largest_piston_speed_m/s": curve.piston_speed.mean(axis=2).tolist(),
        "rms_current_A": curve.current.mean(axis=2).tolist(),
        "rms_tyre_deflection_m": curve.tyre.mean(axis=2).tolist(),
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
        "value": band.value,
        "low": _finite(band.low),
        "high": _finite(band.high),
        "level": 0.95,
        "single_motion_low": band.single_low,
        "single_motion_high": band.single_high,
    }


def _over_draws(band: Band) -> dict[str, Any]:
    return {"value": band.value, "low": band.single_low, "high": band.single_high, "level": 0.95}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
