"""Simulation-based calibration: posteriors of campaigns whose truth comes from the prior itself."""

import json
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any, Final

import jax.numpy as jnp
import numpy as np
from outcome import Outcome, arguments
from ranks import band, p_value, rank
from sine_loops import sine_loops
from work_file import FOLDER, add_row, read_rows

from sysid.likelihood.discrepancy import Covariance, Sizes
from sysid.likelihood.gls import gauss_newton
from sysid.likelihood.observed import Observed, observe
from sysid.models.coordinates import Reference, place_of, valve_at
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.models.generalized_coordinates import GeneralizedCoordinates
from sysid.motion.motion import sine_motion
from sysid.parameters import build
from sysid.uncertainty.chain import draws_of, grow
from sysid.uncertainty.convergence import convergence
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.prior import Prior, prior_of
from sysid.uncertainty.target import harmonics_at, parameters_at
from sysid.uncertainty.warm_up import warm_up

CONDITIONS: Final = ((2.5e-3, 2.0), (2.5e-3, 10.0), (12.5e-3, 0.5), (12.5e-3, 2.5), (25e-3, 1.5))
CURRENTS: Final = {"passive": (0.0,), "symmetric": (0.0, 0.1, 0.2, 0.4)}
SIZES: Final = Sizes(
    gain=0.02, offset=5.0, delay=3e-4, odd=0.02, even=0.01, scale=0.02, width=0.03, steepness=0.02
)
NOISE: Final = 3.0
"""N, of a harmonic."""
WIDE: Final = 1.5
"""Factor of the prior's ratios: campaigns are drawn from it, and must be dampers."""
POINTS: Final = 72
LEFT: Final = 99
"""Draws that the truth is ranked among."""
BUDGET: Final = 40.0
"""s, of one posterior."""
VARIANTS: Final = ("passive",)
"""Of the generalised model; "symmetric" (13 parameters) takes a minute a campaign."""
FIRST_SEED: Final = 50_600_000
CAMPAIGNS: Final = 120
CHANGES: Final = {"as drawn": 1.0, "too narrow": 0.75, "too wide": 1.33}
"""Draws about their median, scaled: what the test must find, and must not."""
HEIGHT: Final = "log-probability"
WORK: Final = FOLDER / "sbc.jsonl"
"""Campaigns that are done, so that a stopped run goes on; delete it if the program changes."""


@dataclass(frozen=True)
class Lab:
    """A test matrix with a covariance that is known and the same for every truth.

    Attributes:
        observed: Its tests, at a nominal damper.
        covariance: Σ.
        root: [L·m, L·m], a square root of Σ.
        prior: What truths are drawn from, and what posteriors believe.
        nominal: [n] coordinates of the nominal damper.
    """

    observed: Observed
    covariance: Covariance
    root: np.ndarray
    prior: Prior
    nominal: np.ndarray


def lab_of(variant: str) -> Lab:
    """The test matrix of a variant of the generalised model."""
    rows = np.array([(a, f, i) for a, f in CONDITIONS for i in CURRENTS[variant]])
    amplitude, frequency, current = rows.T
    motion = sine_motion(amplitude, frequency, current, points=POINTS)
    table = dict(LOW_SYMMETRIC)
    if variant == "passive":
        table |= {"k_2": 0.0, "k_3": 0.0}
    valve = build(Generalized, table)
    force = np.asarray(valve.force(motion))
    ids = [f"test-{k}" for k in range(len(rows))]
    loops = sine_loops(ids, motion, force, (amplitude, frequency, current, None))
    reference = Reference(
        force=float(np.sqrt(np.mean(force**2))), speed=float(loops.peak_velocity.max()),
        current=float(current.max()) or 1.0, length=float(amplitude.max()),
    )  # fmt: skip
    coordinates = GeneralizedCoordinates(reference, variant)  # pyright: ignore[reportArgumentType]
    nominal = np.asarray(place_of(coordinates, valve))
    observed = observe(loops, points=POINTS)
    residual = observed.look(coordinates, nominal)[0]
    observed = observed.beside(Damper(valve_at(coordinates, jnp.asarray(nominal))), residual)
    parts = replace(observed.parts, noise=np.full(len(rows), NOISE))
    covariance = Covariance(parts, SIZES)
    m = parts.force.size
    precision = covariance.weighted(np.eye(m).reshape(*parts.force.shape, m)).reshape(m, m)
    values, axes = np.linalg.eigh(0.5 * (precision + precision.T))
    prior = prior_of(coordinates, nominal, WIDE)
    return Lab(replace(observed, parts=parts), covariance, axes / np.sqrt(values), prior, nominal)


def truth_of(lab: Lab, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Parameters drawn from the prior, and their coordinates."""
    declared, coordinates = lab.prior.declared, lab.prior.coordinates
    while True:
        theta = np.empty(len(declared))
        for k, spec in enumerate(declared):
            value = np.nan
            while not spec.low <= value <= spec.high:
                value = spec.typical * (
                    WIDE ** rng.standard_normal() if spec.scale == "log" else rng.standard_cauchy()
                )
            theta[k] = value
        table = dict(LOW_SYMMETRIC) | {"k_2": 0.0, "k_3": 0.0}
        table |= {spec.symbol: float(z) for spec, z in zip(declared, theta, strict=True)}
        table |= {follower: table[leader] for follower, leader in coordinates.ties}
        u = np.asarray(place_of(coordinates, build(Generalized, table)))
        # coordinates do not reach every corner that the prior allows; truths are from where they do
        if np.allclose(parameters_at(lab.prior, u[None])[0], theta, rtol=1e-6):
            return theta, u


def campaign(lab: Lab, truth: np.ndarray, rng: np.random.Generator) -> ErrorModel:
    """What is measured of a truth, with the likelihood that it was drawn from."""
    force = harmonics_at(lab.prior, lab.observed, truth[None])[0]
    error = (lab.root @ rng.standard_normal(force.size)).reshape(force.shape)
    observed = replace(lab.observed, measured=force + error)

    def look(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return observed.look(lab.prior.coordinates, u)

    fits = [gauss_newton(look, start, lab.covariance) for start in (lab.nominal, truth)]
    best = min(fits, key=lambda fit: fit.cost)
    return ErrorModel(
        "full", observed, SIZES, lab.covariance, 1.0, best.u, best.information, "Σ known"
    )


def ranked(lab: Lab, seed: int, budget: float = BUDGET) -> dict[str, Any]:
    """Ranks of one truth among draws from its posterior."""
    started = time.perf_counter()
    rng = np.random.default_rng(seed)
    theta, u = truth_of(lab, rng)
    errors = campaign(lab, u, rng)
    symbols = [spec.symbol for spec in lab.prior.declared]
    with ThreadPoolExecutor(2) as executor:
        ready = warm_up(lab.prior, errors, executor, seed, lambda line: None, memoryless=True)
        blocks, evidence, message = grow(
            ready.course, lambda z: convergence(z, symbols), executor,
            deadline=time.monotonic() + budget,
        )  # fmt: skip
    places = draws_of(blocks).reshape(-1, len(u))
    heights = np.concatenate([b.log_probability for b in blocks], axis=1).ravel()
    some = rng.choice(len(places), size=LEFT, replace=False)
    draws, middle = parameters_at(lab.prior, places[some]), np.median(places, axis=0)
    middle = parameters_at(lab.prior, middle[None])[0]
    ranks = {
        name: dict(zip(symbols, rank(middle + factor * (draws - middle), theta), strict=True))
        for name, factor in CHANGES.items()
    }
    height = float(ready.target(u[None])[0])
    ranks["as drawn"][HEIGHT] = int(np.sum(heights[some] < height))
    return {
        "seed": seed, "ranks": ranks, "converged": evidence.reached, "message": message,
        "steps": evidence.steps, "s": round(time.perf_counter() - started, 1),
    }  # fmt: skip


def main() -> None:
    campaigns, quick = arguments(__doc__ or "", CAMPAIGNS, 2)
    outcome = Outcome("sbc", "Simulation-based calibration of the posterior")
    outcome.say(
        "Truths are drawn from the prior (differences as `sysid fit` believes them; ratios within",
        f"a factor of {WIDE:g}), campaigns from the model with a known Σ: noise, errors of the rig",
        "and of the laws.  The posterior is drawn as `sysid fit` does, mode, reduced likelihood",
        f"and stopping rule included.  Each truth is ranked among {LEFT} draws; p: of ranks as",
        "uneven as these, were the draws right (distribution function, Säilynoja et al. 2022).",
        "The last two columns are the same draws about their median, scaled by",
        f"{CHANGES['too narrow']:g} and {CHANGES['too wide']:g}: the test must find them.",
    )
    for variant in VARIANTS:
        lab = lab_of(variant)
        rows = list(_rows(lab, variant, campaigns, quick))
        report(outcome, lab, variant, rows)
    outcome.finish(keep=not quick)


def report(outcome: Outcome, lab: Lab, variant: str, rows: list[dict[str, Any]]) -> None:
    """Table of one variant."""
    quantities = [*(s.symbol for s in lab.prior.declared), HEIGHT]
    table, found = [], {}
    for name in quantities:
        told = []
        for change in CHANGES:
            ranks = [r["ranks"][change][name] for r in rows if name in r["ranks"][change]]
            told.append(p_value(np.array(ranks), LEFT) if ranks else None)
        found[name] = dict(zip(CHANGES, told, strict=True))
        table.append((name, *("" if p is None else f"{p:.3f}" for p in told)))
    least = {
        change: min(p for z in found.values() if (p := z[change]) is not None)
        * sum(z[change] is not None for z in found.values())
        for change in CHANGES
    }
    missed = sum(not r["converged"] for r in rows)
    outcome.say(f"## {variant.capitalize()}: {len(quantities) - 1} parameters")
    outcome.say(
        f"{len(rows)} campaigns of {lab.observed.tests} loops, {missed} of them not converged",
        f"within {BUDGET:g} s (they count like the others).",
    )
    outcome.table(("quantity", *(f"p, {change}" for change in CHANGES)), table)
    outcome.say(
        "Least p times the number of quantities: "
        + ", ".join(f"{change} {min(p, 1.0):.3g}" for change, p in least.items())
        + "."
    )
    z, low, high = band(len(rows), LEFT)
    middle = int(np.argmin(np.abs(z - 0.5)))
    outcome.say(
        f"The 95 % band of the distribution function at the middle is {low[middle]:.2f} to",
        f"{high[middle]:.2f} for so many campaigns.",
    )
    outcome.numbers[variant] = {
        "campaigns": len(rows), "not_converged": missed, "p": found, "bonferroni": least,
    }  # fmt: skip


def _rows(lab: Lab, variant: str, campaigns: int, quick: bool) -> Iterator[dict[str, Any]]:
    rows = () if quick else read_rows(WORK)
    done = {r["seed"]: r for r in rows if r["variant"] == variant}
    for seed in range(FIRST_SEED, FIRST_SEED + campaigns):
        if seed not in done:
            done[seed] = {"variant": variant, **ranked(lab, seed)}
            print(json.dumps(done[seed]), flush=True)
            if not quick:
                add_row(done[seed], WORK)
        yield done[seed]


if __name__ == "__main__":
    main()
