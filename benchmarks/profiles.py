"""Profiles of all parameters: how fast, and how often their intervals hold the truth."""

import time
from typing import Any, Final

import jax.numpy as jnp
import numpy as np
from outcome import Outcome, arguments
from scipy.optimize import NonlinearConstraint, minimize
from work_file import FOLDER, each_misfit

from sysid.identification.fit import fit_loops
from sysid.identification.result import Fit
from sysid.rig.trial_campaign import make_trial
from sysid.rig.trial_design import TrialDesign
from sysid.trials.proportions import Share
from sysid.uncertainty.covariance import sandwich
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.free_parameters import free_parameters
from sysid.uncertainty.profiles import Profile, profiles
from sysid.uncertainty.sample import errors_of

POINTS: Final = 360
MISFITS: Final = (0.0, 0.02)
CAMPAIGNS: Final = 300
"""Of each misfit."""
FIRST_SEED: Final = 30_500_000
WORK: Final = FOLDER / "profiles.jsonl"
"""Campaigns that are done, so that a stopped run goes on; delete it if the program changes."""
KINDS: Final = ("profile", "linear", "sandwich")
COMPARED: Final = ("k_3", "a_1")
"""Profiled by SciPy, too: the most bent one and a straight one."""


def fitted(seed: int, misfit: float) -> tuple[Fit, ErrorModel, dict[str, float]]:
    """A campaign of the virtual rig, its fit and likelihood, and the truth."""
    design = TrialDesign(fewest=110, most=110, points=POINTS, misfit=misfit)
    trial = make_trial(seed, (), design=design)
    truth = trial.truth.parameters
    even = truth.get("k_5", 0.0) == truth.get("k_6", 0.0) == 0.0
    fit = fit_loops(trial.loops, variant="symmetric" if even else "asymmetric")
    return fit, errors_of(fit, trial.loops, "full"), truth


def held(seed: int, misfit: float) -> dict[str, Any]:
    """Symbol of each identified parameter → its interval holds the truth."""
    fit, errors, truth = fitted(seed, misfit)
    found = profiles(fit, errors)
    inside = {p.symbol: bool(p.low <= truth[p.symbol] <= p.high) for p in found if p.identified}
    linear = _linear(fit, errors, found, truth)
    robust = {
        p.symbol: bool(p.low <= truth[p.symbol] <= p.high)
        for p in sandwich(fit).parameters
        if p.symbol in inside
    }
    return {"seed": seed, "misfit": misfit, "profile": inside, "linear": linear, "sandwich": robust}


def _linear(
    fit: Fit, errors: ErrorModel, found: tuple[Profile, ...], truth: dict[str, float]
) -> dict[str, bool]:
    """The same for ± 1.96 standard errors."""
    at, slopes = (np.asarray(z) for z in free_parameters(fit.coordinates, jnp.asarray(errors.u)))
    inverse = np.linalg.pinv(errors.information, hermitian=True)
    sd = np.sqrt(np.maximum(np.diagonal(slopes @ inverse @ slopes.T), 0.0))
    off = {s: abs(v - truth[s]) / d for s, v, d in zip(fit.coordinates.free, at, sd, strict=True)}
    return {p.symbol: bool(off[p.symbol] <= 1.96) for p in found if p.identified}


def timed(fit: Fit, errors: ErrorModel) -> dict[str, float]:
    """Seconds of the clock and of all processors for all; for some, by SciPy and by us."""
    profiles(fit, errors)
    wall, cpu = time.perf_counter(), time.process_time()
    profiles(fit, errors)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    begin = time.process_time()
    ours = profiles(fit, errors, COMPARED, threads=1)
    mine, begin = time.process_time() - begin, time.process_time()
    worst = max(_by_scipy(fit, errors, p) for p in ours)
    theirs = time.process_time() - begin
    return {"wall": wall, "cpu": cpu, "ours": mine, "scipy": theirs, "worse": worst}


def _by_scipy(fit: Fit, errors: ErrorModel, profile: Profile) -> float:
    """The same points by constrained minimisation: by how much the rise is larger, at most."""
    coordinates, k = fit.coordinates, fit.coordinates.free.index(profile.symbol)
    unit = abs(profile.best)

    def cost(u: np.ndarray) -> tuple[float, np.ndarray]:
        residual, jacobian = errors.observed.look(coordinates, u)
        both = np.concatenate([jacobian, residual[:, :, None]], axis=2)
        gram = errors.covariance.inner(both, both)
        return float(gram[-1, -1]), -2.0 * gram[:-1, -1]

    def place(u: np.ndarray, which: int) -> np.ndarray:
        return np.asarray(free_parameters(coordinates, jnp.asarray(u))[which][k]) / unit

    least, more = cost(np.asarray(errors.u))[0], []
    middle = int(np.argmin(profile.rise))
    for side in (range(middle - 1, -1, -1), range(middle + 1, profile.values.size)):
        start = np.asarray(errors.u)
        for point in side:
            end = float(profile.values[point]) / unit
            fixed = NonlinearConstraint(
                lambda u: place(u, 0), end, end,
                jac=lambda u: place(u, 1)[None],  # pyright: ignore[reportArgumentType] documented
            )  # fmt: skip
            found = minimize(
                cost, start, jac=True, method="SLSQP", constraints=[fixed],
                options={"maxiter": 200, "ftol": 1e-9},
            )  # fmt: skip
            start = found.x
            more.append(float(found.fun) - least - float(profile.rise[point]))
    return max(more)


def main() -> None:
    """Time one campaign, then count what is missing in the work file."""
    campaigns, quick = arguments(__doc__ or "", CAMPAIGNS, 1)
    fit, errors, _ = fitted(FIRST_SEED - 1, 0.02)
    took = timed(fit, errors)
    seeds = range(FIRST_SEED, FIRST_SEED + campaigns)
    rows = list(each_misfit(held, seeds, MISFITS, None if quick else WORK))
    outcome = Outcome("profiles", "Profile likelihoods of the generalised model")
    outcome.say(
        "W11's tests with v_m ≤ 0.4 m/s: 110 loops of 360 points on the virtual rig with its",
        "errors, likelihood with the full covariance Σ.",
    )
    outcome.say(
        f"All {fit.coordinates.size} parameters: {took['wall']:.1f} s, {took['cpu']:.1f} s of all",
        f"processors, warm (aim 20 s).  The points of {' and '.join(COMPARED)} by SciPy's SLSQP",
        f"with our gradients take {took['scipy'] / took['ours']:.0f} × the processor time of ours,",
        f"and their rise is larger by {took['worse']:.2g} at most.",
    )
    table = []
    for misfit in MISFITS:
        here = [r for r in rows if r["misfit"] == misfit]
        if not here:
            continue
        shares = [
            Share(sum(sum(r[kind].values()) for r in here), sum(len(r[kind]) for r in here))
            for kind in KINDS
        ]
        table.append((f"{misfit:.0%}", len(here), *shares))
        outcome.numbers[f"misfit_{misfit:g}"] = {
            "campaigns": len(here),
            **{kind: z.as_dict() for kind, z in zip(KINDS, shares, strict=True)},
            "by_symbol": _by_symbol(here),
        }
    outcome.table(
        ("error of the laws", "campaigns", "profile intervals that hold the truth (aim 92–98 %)",
         "± 1.96 standard errors under Σ", "sandwich over conditions"), table,
    )  # fmt: skip
    outcome.say(
        "Parameters whose profile is open on one side or too wide do not count.  Parameters of one",
        "campaign share its errors, so the shares are surer than they look only over many",
        "campaigns.",
    )
    wrong = [r for r in rows if r["misfit"] > 0.0]
    missed = sorted(
        ((s, z["share"]) for s, z in _by_symbol(wrong).items()), key=lambda pair: pair[1]
    )
    worst = ", ".join(f"{s} {share:.0%}" for s, share in missed[:5])
    outcome.say(f"Where the laws are wrong, the profiles' worst are: {worst}.")
    outcome.numbers |= took
    outcome.finish(keep=not quick)


def _by_symbol(rows: list[dict[str, Any]]) -> dict[str, Any]:
    symbols = sorted({s for r in rows for s in r["profile"]})
    of = {s: [r["profile"][s] for r in rows if s in r["profile"]] for s in symbols}
    return {s: Share(sum(z), len(z)).as_dict() for s, z in of.items()}


if __name__ == "__main__":
    main()
