"""The fit of the measured UTFSM damper: its error, and whether every seed finds the same."""

import argparse
import time
from pathlib import Path
from typing import Final

import numpy as np
from outcome import Outcome

from sysid.cli.selection import select
from sysid.data.campaign import load_campaign
from sysid.identification.fit import fit_loops
from sysid.uncertainty.covariance import sandwich

ROOT: Final = Path(__file__).resolve().parents[1]
DATA: Final = ROOT.parent / "shared" / "data" / "utfsm"
MANIFEST: Final = ROOT / "datasets" / "utfsm" / "campaign.toml"
ERROR_LIMIT, SPREAD_LIMIT = 0.106, 1e-3


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, nargs="?", default=DATA, help=f"default {DATA}")
    parser.add_argument("--campaigns", type=int, help="seeds, default 20")
    parser.add_argument("--quick", action="store_true", help="3 seeds, nothing written")
    given = parser.parse_args()
    if not given.folder.is_dir():
        print(
            f"Skipped: {given.folder} is not here; datasets/utfsm/README.md says where to get it."
        )
        return
    chosen = select(load_campaign(given.folder, MANIFEST), (), ())
    seeds = given.campaigns or (3 if given.quick else 20)
    fits, seconds = [], []
    for seed in range(seeds):
        begin = time.perf_counter()
        fits.append(fit_loops(chosen.loops, weights="peak", left_out=chosen.left_out, seed=seed))
        seconds.append(time.perf_counter() - begin)
    costs = np.array([fit.cost for fit in fits])
    spread = float(costs.max() / costs.min() - 1.0)
    fit = fits[0]
    estimates = sandwich(fit)
    outcome = Outcome("utfsm", "UTFSM measurements, 16 parameters, weights peak")
    outcome.table(
        ("", "found", "target"),
        (
            ("tests fitted", len(chosen.loops.ids), "18"),
            ("mean RMSE/max|F|", f"{100 * fit.mean_nrmse:.2f} %", f"≤ {100 * ERROR_LIMIT:.1f} %"),
            (
                f"cost of the worst of {seeds} seeds over the best",
                f"{100 * spread:.4f} %", f"≤ {100 * SPREAD_LIMIT:.1f} %",
            ),
            ("fits that said they converged", sum(f.result.name == "converged" for f in fits), ""),
            ("starts, median (most)", f"{np.median([f.starts for f in fits]):.0f} "
             f"({max(f.starts for f in fits)})", ""),
            ("s a fit, warm, median", f"{np.median(seconds[1:]):.2f}", ""),
        ),
    )  # fmt: skip
    outcome.say("Left out: " + "; ".join(f"{k}: {why}" for k, why in chosen.left_out.items()))
    outcome.say("Not determined by these data:")
    outcome.lines += ["", *(f"- {sentence}" for sentence in estimates.undetermined)]
    outcome.table(
        ("test", "RMSE, N", "RMSE/max|F|, %", "fit, %", "repeatability, N"),
        [
            (t.id, f"{t.rmse:.1f}", f"{100 * t.nrmse:.1f}", f"{t.fit_percent:.1f}",
             f"{t.noise_floor:.1f}")
            for t in fit.tests if t.used
        ],
    )  # fmt: skip
    outcome.table(
        ("parameter", "value", "unit", "95 % interval", "identified"),
        [
            (p.symbol, f"{p.value:.4g}", p.unit, f"{p.low:.3g} to {p.high:.3g}",
             "yes" if p.identified else "no")
            for p in estimates.parameters
        ],
    )  # fmt: skip
    outcome.numbers = {
        "mean_nrmse": fit.mean_nrmse, "spread": spread, "costs": costs.tolist(),
        "starts": [f.starts for f in fits], "undetermined": list(estimates.undetermined),
        "tests": {t.id: t.nrmse for t in fit.tests if t.used},
    }  # fmt: skip
    outcome.finish(keep=not given.quick)


if __name__ == "__main__":
    main()
