"""How often bands of the force hold it, on the virtual rig with right and with wrong laws."""

from dataclasses import replace
from typing import Any, Final

import numpy as np
from outcome import Outcome, arguments
from work_file import FOLDER, each_misfit

from sysid.identification.conditions import conditions
from sysid.identification.fit import fit_loops
from sysid.motion.motion import loop_motion
from sysid.rig.trial_campaign import make_trial
from sysid.rig.trial_design import TrialDesign
from sysid.trials.proportions import bootstrap
from sysid.uncertainty.bands import Band, predict_at
from sysid.uncertainty.conformal import conformal
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.left_out import leave_conditions_out
from sysid.uncertainty.loop_bands import KINDS
from sysid.uncertainty.quantities import QUANTITIES
from sysid.uncertainty.sample import errors_of

MISFITS: Final = (0.0, 0.02)
CAMPAIGNS: Final = 20
"""Of each misfit."""
FIRST_SEED: Final = 50_700_000
LEFT_OUT: Final = 2
"""Conditions that are not fitted; 20 of 22 remain."""
DRAWS: Final = 400
FINE: Final = 720
"""Points of a cycle that the virtual rig computes: with as many, no bin is wider than a point."""
WORK: Final = FOLDER / "bands.jsonl"
"""Campaigns that are done, so that a stopped run goes on; delete it if the program changes."""


def normal_draws(errors: ErrorModel, rng: np.random.Generator) -> np.ndarray:
    """The normal density at the most probable place: what forces go by, it gets right."""
    scale = np.sqrt(np.diagonal(errors.information))
    values, axes = np.linalg.eigh(errors.information / scale[:, None] / scale[None, :])
    wide = axes / np.sqrt(np.maximum(values, 1e-3))
    return errors.u + (rng.standard_normal((DRAWS, len(scale))) @ wide.T) / scale


def one(seed: int, misfit: float) -> dict[str, Any]:
    """Shares of one campaign that bands hold."""
    design = TrialDesign(fewest=110, most=110, points=360, misfit=misfit)
    trial = make_trial(seed, (), design=design)
    exact = _exact(seed, design)
    rng = np.random.default_rng(seed)
    condition = conditions(trial.loops)
    out = np.isin(condition, rng.choice(int(condition.max()) + 1, LEFT_OUT, replace=False))
    loops = trial.loops.select(~out)
    fit = fit_loops(loops, variant="symmetric")
    errors = errors_of(fit, loops, "full")
    u = normal_draws(errors, rng)
    scores = conformal(leave_conditions_out(errors, fit.coordinates))
    row: dict[str, Any] = {"seed": seed, "misfit": misfit}
    for name, which in (("fitted", ~out), ("left out", out)):
        some, truth = trial.loops.select(which), exact[which]
        motion = loop_motion(some)
        found = predict_at(u, fit.coordinates, motion, errors=errors, seed=seed)
        forces, read = found.bands(KINDS, QUANTITIES)
        peak = np.abs(truth).max(axis=1)
        row[name] = {
            **{
                kind: _told(forces[kind], some.force if kind == "recorded" else truth, peak)
                for kind in KINDS
            },
            "quantities": [
                float(np.mean(band.holds(quantity.read(truth[None], motion)[0])))
                for quantity, band in zip(QUANTITIES, read["laws"], strict=True)
            ],
        }
        whole = scores.band(fit.coordinates, motion)
        if whole is not None:
            row[name]["conformal"] = [
                float(np.mean(whole.holds(some.force).all(axis=1))), _width(whole, peak),
            ]  # fmt: skip
    return row


def _exact(seed: int, design: TrialDesign) -> np.ndarray:
    """Force of the damper at the points of its loops, N.

    A recorded one is the mean over a phase bin, and higher at standstill, where 1 + k_v |v| has its
    kink: enough to leave a narrow interval.
    """
    fine = replace(design, points=FINE)
    return make_trial(seed, (), design=fine).truth.force[:, :: FINE // design.points]


def _told(band: Band, values: np.ndarray, peak: np.ndarray) -> list[float]:
    return [float(np.mean(band.holds(values))), _width(band, peak)]


def _width(band: Band, peak: np.ndarray) -> float:
    return float(np.mean((band.high - band.low) / peak[:, None]) / 2.0)


def main() -> None:
    campaigns, quick = arguments(__doc__ or "", CAMPAIGNS, 1)
    seeds = range(FIRST_SEED, FIRST_SEED + campaigns)
    rows = list(each_misfit(one, seeds, MISFITS, None if quick else WORK))
    outcome = Outcome("bands", "Bands of the force on the virtual rig")
    outcome.say(
        "W11's tests with v_m ≤ 0.4 m/s, 110 loops with errors of the rig; 20 of the 22 conditions",
        "are fitted (symmetric variant, full Σ).  Truth: the force of the damper without errors of",
        f"the rig.  {DRAWS} draws of the normal density at the most probable parameters.",
    )
    for misfit in MISFITS:
        here = [r for r in rows if r["misfit"] == misfit]
        if not here:
            continue
        table, numbers = [], {}
        for kind in (*KINDS, "conformal"):
            cells = []
            for name in ("fitted", "left out"):
                both = np.array([r[name][kind] for r in here if kind in r[name]])
                share, low, high = bootstrap(lambda k, z=both: float(z[k, 0].mean()), len(both))
                cells += [f"{share:.1%} ({low:.1%} to {high:.1%})", f"± {both[:, 1].mean():.2%}"]
                numbers[f"{kind}, {name}"] = {"share": share, "low": low, "high": high,
                                              "half_width": float(both[:, 1].mean())}  # fmt: skip
            table.append((_WORDS[kind], *cells))
        for k, quantity in enumerate(QUANTITIES):
            cells = []
            for name in ("fitted", "left out"):
                inside = np.array([r[name]["quantities"][k] for r in here])
                share, low, high = bootstrap(lambda j, z=inside: float(z[j].mean()), len(inside))
                cells += [f"{share:.1%} ({low:.1%} to {high:.1%})", ""]
                numbers[f"{quantity.name}, {name}"] = {"share": share, "low": low, "high": high}
            table.append((f"{quantity.name}, with errors of the laws", *cells))
        outcome.say(f"## Laws {misfit:.0%} wrong, {len(here)} campaigns")
        outcome.table(
            ("95 % band holds", "fitted conditions", "of max|F|", "conditions left out",
             "of max|F|"), table,
        )  # fmt: skip
        outcome.numbers[f"misfit_{misfit:g}"] = {"campaigns": len(here), **numbers}
    outcome.say("Intervals: bootstrap over campaigns.")
    outcome.finish(keep=not quick)


_WORDS: Final = {
    "parameters": "points of the damper's force, parameters alone",
    "laws": "the same, with errors of the laws",
    "recorded": "points of what was recorded",
    "conformal": "whole recorded loops, conformal",
}


if __name__ == "__main__":
    main()
