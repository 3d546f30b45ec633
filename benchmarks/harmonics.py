"""What fifteen harmonics a loop, instead of more, change of parameters under Σ."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Final

import jax.numpy as jnp
import numpy as np
from outcome import Outcome, arguments

from sysid.cli.selection import select
from sysid.data.campaign import load_campaign
from sysid.data.loops import Loops
from sysid.identification.fit import fit_loops
from sysid.identification.result import Fit
from sysid.likelihood.compress import HARMONICS
from sysid.likelihood.discrepancy import Covariance
from sysid.likelihood.gls import gauss_newton
from sysid.likelihood.observed import observe
from sysid.models.coordinates import valve_at
from sysid.models.damper import Damper
from sysid.rig.trial_campaign import make_trial
from sysid.rig.trial_design import TrialDesign
from sysid.rig.truth import open_seal
from sysid.trials.misfit import misfit_of
from sysid.uncertainty.error_model import ErrorModel, errors_at, errors_at_best
from sysid.uncertainty.estimate import Estimate
from sysid.uncertainty.propagated import by_gls
from sysid.uncertainty.sample import observed_of

MISFITS: Final = (0.0, 2.0)
"""RMS that the refitted model leaves of a perfect measurement, % of the RMS force."""
FIRST_SEED: Final = 61_000_100
CAMPAIGNS: Final = 20
"""Of each misfit."""
RAW: Final = ("virtual-w11-low", "virtual-w11-high", "virtual-w11-asymmetric")
"""Shipped raw files; the force of the last jumps at the peaks of velocity."""
DATASETS: Final = Path(__file__).parents[1] / "datasets"
ALL: Final = 10_000
MORE: Final = (30, 60, ALL)
AS_WIDE: Final = 10.0
"""Parameters whose interval becomes so many times wider or narrower are not compared: they are at
the edge of what the data determine."""


@dataclass(frozen=True)
class Compared:
    """One parameter in fifteen harmonics and in more.

    Attributes:
        few: With fifteen.
        more: With more.
        truth: The generator's.
    """

    few: Estimate
    more: Estimate
    truth: float

    @property
    def shift(self) -> float:
        """Standard deviations of the first."""
        return abs(self.more.value - self.few.value) / self.few.sd

    @property
    def told(self) -> float:
        """Root mean square that the shift has if Σ is right: √|1 − r²|, r the ratio of sds."""
        return float(np.sqrt(abs(1.0 - (self.more.sd / self.few.sd) ** 2)))

    def misses(self) -> tuple[float, float]:
        """Distances from the truth, in their own standard deviations."""
        return (
            abs(self.few.value - self.truth) / self.few.sd,
            abs(self.more.value - self.truth) / self.more.sd,
        )


def finer_errors(
    fit: Fit, loops: Loops, errors: ErrorModel, place: np.ndarray, points: int, harmonics: int
) -> ErrorModel:
    """The same sizes of Σ, smoothness and noise on more points and in more harmonics.

    Args:
        fit: The fit, for its coordinates.
        loops: Those that were fitted.
        errors: In fifteen harmonics.
        place: [n] parameters that its Σ is taken at.
        points: To simulate on.
        harmonics: To compare.
    """
    finer = observe(loops, points=points, harmonics=harmonics)
    residual = finer.look(fit.coordinates, place)[0]
    finer = finer.beside(Damper(valve_at(fit.coordinates, jnp.asarray(place))), residual)
    known = errors.observed.parts
    parts = replace(finer.parts, noise=known.noise, kernel=known.kernel, lengths=known.lengths)
    finer = replace(finer, parts=parts)
    return replace(errors, observed=finer, covariance=Covariance(finer.parts, errors.sizes))


def compared(
    fit: Fit, loops: Loops, truth: Mapping[str, float]
) -> Iterator[tuple[int, list[Compared]]]:
    """Parameters that both determine, for each number of harmonics."""
    observed = observed_of(fit, loops)
    near = errors_at(fit, observed)
    errors = errors_at_best(fit, observed, near)
    few = _estimates(fit, errors, errors)
    points = loops.force.shape[1]
    for harmonics in MORE:
        more = _estimates(fit, errors, finer_errors(fit, loops, errors, near.u, points, harmonics))
        yield harmonics, [
            Compared(few[s], more[s], truth[s])
            for s in fit.coordinates.free
            if few[s].identified and more[s].identified
            and 1.0 / AS_WIDE < more[s].sd / few[s].sd < AS_WIDE
        ]  # fmt: skip


def _estimates(fit: Fit, start: ErrorModel, errors: ErrorModel) -> dict[str, Estimate]:
    gls = gauss_newton(partial(errors.observed.look, fit.coordinates), start.u, errors.covariance)
    here = replace(errors, u=gls.u, information=gls.information)
    return {p.symbol: p for p in by_gls(fit, here).parameters}


def simulated(seed: int, percent: float) -> Iterator[tuple[int, list[Compared]]]:
    """Of one campaign on the virtual rig."""
    size = misfit_of(seed, percent, TrialDesign(fewest=110, most=110)).size
    trial = make_trial(seed, design=TrialDesign(fewest=110, most=110, misfit=size))
    fit = fit_loops(trial.loops, variant="symmetric")
    return compared(fit, trial.loops, trial.truth.parameters)


def raw(name: str) -> Iterator[tuple[int, list[Compared]]]:
    """Of a shipped dataset."""
    folder = DATASETS / name
    chosen = select(load_campaign(folder), (), ())
    fit = fit_loops(chosen.loops, left_out=chosen.left_out)
    return compared(fit, chosen.loops, open_seal(folder / "sealed" / "truth.json").parameters)


def rows(found: dict[int, list[Compared]]) -> tuple[list[tuple[object, ...]], dict[str, object]]:
    """A row for each number of harmonics, and the same as numbers."""
    table, numbers = [], {}
    for harmonics, of in found.items():
        name = "all" if harmonics == ALL else str(harmonics)
        ratio = np.array([c.more.sd / c.few.sd for c in of])
        shift, told = np.array([c.shift for c in of]), np.array([c.told for c in of])
        miss = np.array([c.misses() for c in of])
        holds = np.array([[e.low <= c.truth <= e.high for e in (c.few, c.more)] for c in of])
        rms = np.sqrt(np.median(miss**2, axis=0) / 0.455)  # of a normal density, whatever the tails
        table.append(
            (
                name, len(of), f"{np.median(ratio):.3f} ({ratio.min():.2f})",
                f"{np.median(shift):.3f} ({shift.max():.2f})",
                f"{np.median(told):.3f} ({told.max():.2f})",
                f"{rms[0]:.2f} → {rms[1]:.2f}",
                f"{holds[:, 0].mean():.1%} → {holds[:, 1].mean():.1%}",
            )
        )  # fmt: skip
        numbers[name] = {
            "parameters": len(of), "sd_ratio": float(np.median(ratio)),
            "shift": float(np.median(shift)), "largest_shift": float(shift.max()),
            "told": float(np.median(told)), "miss": rms.tolist(),
            "holds": holds.mean(axis=0).tolist(),
        }  # fmt: skip
    return table, numbers


HEAD: Final = (
    "harmonics", "parameters", "ratio of sds, median (least)", "shift, sd: median (largest)",
    "shift that such a ratio tells", "distance from the truth, sd", "95 % interval holds it",
)  # fmt: skip


def main() -> None:
    campaigns, quick = arguments(__doc__ or "", CAMPAIGNS, 1)
    outcome = Outcome("harmonics", "Fifteen harmonics a loop instead of more")
    outcome.say(
        "Parameters by generalised least squares under Σ and their intervals to first order, in",
        f"{HARMONICS} harmonics a loop and in more: same sizes of Σ, same smoothness, same noise.",
        "Only parameters that both determine.  If Σ were right for the harmonics that are left",
        "out, a parameter would move by √(1 − r²) standard deviations (root mean square), r the",
        "ratio of its standard deviations.",
    )
    groups = [
        (
            f"110 loops of 360 points on the virtual rig, the refitted model leaves {misfit:g} %",
            [simulated(FIRST_SEED + k, misfit) for k in range(campaigns)],
        )
        for misfit in MISFITS
    ]  # fmt: skip
    groups += [(f"Raw files of `datasets/{name}`", [raw(name)]) for name in RAW]
    for title, many in groups:
        found: dict[int, list[Compared]] = {}
        for campaign in many:
            for harmonics, of in campaign:
                found.setdefault(harmonics, []).extend(of)
        table, outcome.numbers[title] = rows(found)
        outcome.say(f"## {title}")
        outcome.table(HEAD, table)
    outcome.say(
        "Distances: median over parameters, scaled so that it is 1 for errors of the size that the",
        "standard deviations say.",
    )
    outcome.finish(keep=not quick)


if __name__ == "__main__":
    main()
