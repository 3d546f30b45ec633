"""Posterior of the 16 parameters from 110 loops: time, evaluations, moves, compression."""

import argparse
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import emcee
import numpy as np
from campaigns import Campaign
from emcee.autocorr import integrated_time
from emcee.moves import DEMove, DESnookerMove, StretchMove
from harmonics import finer_errors
from outcome import Outcome
from paper_symbols import LOW, PaperFit

from sysid.data.loops import Loops
from sysid.identification.fit import fit_loops
from sysid.identification.result import Fit
from sysid.likelihood.observed import observe
from sysid.parameters import as_dict
from sysid.rig.trial_campaign import make_trial
from sysid.rig.trial_design import TrialDesign
from sysid.uncertainty.chain import BLOCK, walk_all
from sysid.uncertainty.compression import CompressionError, compression_error
from sysid.uncertainty.convergence import convergence
from sysid.uncertainty.doubt import doubt_of
from sysid.uncertainty.ensemble import random_state
from sysid.uncertainty.error_model import (
    ErrorModel,
    error_model,
    errors_at,
    errors_at_best,
)
from sysid.uncertainty.jump import jump_fitted
from sysid.uncertainty.moves import moves
from sysid.uncertainty.posterior import Posterior
from sysid.uncertainty.prior import Prior, prior_of
from sysid.uncertainty.sample import points_for, sample_posterior
from sysid.uncertainty.target import exact_log_likelihood
from sysid.uncertainty.warm_up import Ready, warm_up

SEED = 3
KINDS = ("independent", "power")
"""Likelihoods that are compared with the full one."""
MISFIT = 0.02
POINTS = 360
REWEIGHTED = 240
"""Draws at which the likelihood of all points is computed."""
ONE_DENSITY = 20_000
"""Draws of the mixture that one t density is fitted to, for comparison."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few steps, nothing written")
    quick = parser.parse_args().quick
    design = TrialDesign(fewest=110, most=110, points=POINTS, misfit=MISFIT)
    trial = make_trial(SEED, (), design=design)
    fit = fit_loops(trial.loops)
    outcome = Outcome("posterior", "Posterior of the generalised model")
    outcome.say(
        f"W11's tests with v_m ≤ 0.4 m/s: {len(trial.loops.ids)} loops of {POINTS} points on the",
        f"virtual rig, with errors of the rig and {MISFIT:.0%} of errors in the damper's laws; 16",
        "free parameters.  The machine was shared with other work: compare CPU time and rates of",
        "one run rather than seconds between runs.",
    )
    posterior = timed(fit, trial.loops, outcome)
    likelihoods(fit, trial.loops, outcome, KINDS[:1] if quick else KINDS)
    observed = observe(trial.loops, points=points_for(fit.model, trial.loops))
    near = errors_at(fit, observed)
    errors = error_model(fit, observed, near=errors_at_best(fit, observed, near))
    prior = prior_of(fit.coordinates, errors.u)
    with ThreadPoolExecutor(2) as executor:
        ready = warm_up(prior, errors, executor, 1, lambda line: None, memoryless=True)
        rates(fit, trial.loops, errors, ready, executor, outcome)
        compare_moves(ready, outcome, 200 if quick else 1500)
    compress(fit, trial.loops, errors, near.u, prior, posterior, outcome)
    outcome.finish(keep=not quick)


def timed(fit: Fit, loops: Loops, outcome: Outcome) -> Posterior:
    """A cold run, and a warm one, which is returned."""
    rows, numbers = [], {}
    posterior = None
    for name, seed in (("first of the process", 0), ("warm", 1)):
        blocks: list[float] = []
        wall, cpu = time.perf_counter(), time.process_time()

        def note(line: str, since: float = wall, to: list[float] = blocks) -> None:
            if "steps" in line:
                to.append(time.perf_counter() - since)

        posterior = sample_posterior(fit, loops, seed=seed, budget=900.0, progress=note)
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        directions = in_directions(posterior)
        steps = posterior.convergence.steps
        needed = BLOCK * -(-steps * 1000.0 / float(directions.min()) // BLOCK)
        enough = blocks[min(int(needed) // BLOCK, len(blocks)) - 1]
        rows.append(
            (
                name, posterior.message, f"{wall:.0f}", f"{cpu:.0f}", f"{posterior.evaluations:,}",
                steps, f"{posterior.convergence.tau.max():.0f}",
                f"{posterior.convergence.rhat.max():.4f}", f"{directions.min():.0f}",
                f"{posterior.convergence.tail.min():.0f}", f"{enough:.0f}",
            )
        )  # fmt: skip
        numbers[name] = {
            "wall_s": wall, "cpu_s": cpu, "evaluations": posterior.evaluations, "steps": steps,
            "least_bulk_ess": float(directions.min()), "s_to_bulk_1000": enough,
            "converged": posterior.convergence.reached,
        }  # fmt: skip
    outcome.say("## Time to the full rule of convergence")
    outcome.table(
        (
            "run", "ended", "wall s", "CPU s", "evaluations", "steps", "largest τ", "largest R̂",
            "least bulk ESS of a direction", "least tail ESS", "wall s to bulk ESS 1000",
        ),
        rows,
    )  # fmt: skip
    outcome.say(
        "Directions: the 16 principal ones of the draws in solver coordinates, those that only the",
        "prior holds included.  Seconds to bulk ESS 1000: to the end of the block of steps",
        "that has it, warm-up included.  Targets: ≤ 60 s to bulk ESS 1000, ≤ 180 s to the full",
        "rule, warm, two idle cores.",
    )
    outcome.numbers["time"] = numbers
    assert posterior is not None
    return posterior


def in_directions(posterior: Posterior) -> np.ndarray:
    """Bulk ESS along the principal directions of the draws in solver coordinates, [16]."""
    u = posterior.coordinates
    flat = u.reshape(-1, u.shape[2])
    scaled = (flat - flat.mean(axis=0)) / flat.std(axis=0)
    axes = np.linalg.eigh(np.corrcoef(flat, rowvar=False))[1]
    along = (scaled @ axes).reshape(u.shape[0], -1, posterior.walkers, u.shape[2])
    return convergence(along, [str(k) for k in range(u.shape[2])]).bulk


def likelihoods(fit: Fit, loops: Loops, outcome: Outcome, kinds: tuple[str, ...]) -> None:
    """The other likelihoods."""
    rows = []
    for kind in kinds:
        cpu = time.process_time()
        p = sample_posterior(fit, loops, likelihood=kind, seed=0)  # pyright: ignore[reportArgumentType]
        cpu = time.process_time() - cpu
        spread = {e.symbol: e.sd for e in p.parameters}
        rows.append(
            (
                kind, p.message, p.convergence.steps, f"{cpu:.0f}", f"{p.evaluations:,}",
                f"{spread['F_0']:.2g}", f"{spread['a_0']:.2g}", p.assumed,
            )
        )  # fmt: skip
    outcome.say("## Other likelihoods")
    head = ("likelihood", "ended", "steps", "CPU s", "evaluations", "sd of F_0", "sd of a_0", "")
    outcome.table(head, rows)


def rates(
    fit: Fit,
    loops: Loops,
    errors: ErrorModel,
    ready: Ready,
    executor: ThreadPoolExecutor,
    outcome: Outcome,
) -> None:
    """Evaluations per second within emcee: ours, and NumPy functions of one walker at a time."""
    peer = PaperFit(Campaign("", as_dict(fit.valve), loops))
    squares = float(np.sum(loops.force**2))
    noise = fit.cost / loops.force.size
    columns = errors.observed.basis.columns / loops.force.shape[1]

    def independent(theta: np.ndarray) -> float:
        if (theta < LOW).any():
            return -np.inf
        return -0.5 * peer.cost(theta) * squares / noise

    def full(theta: np.ndarray) -> float:
        if (theta < LOW).any():
            return -np.inf
        r = peer.residuals(theta).reshape(loops.force.shape) @ columns * np.sqrt(squares)
        return -0.5 * float(errors.covariance.inner(r[:, :, None], r[:, :, None])[0, 0])

    count = len(ready.course.start[0].u)
    truth = np.array(list(as_dict(fit.valve).values()))

    def plain(function: Callable[[np.ndarray], float], steps: int) -> tuple[float, float]:
        start = truth * (1.0 + 1e-4 * np.random.default_rng(0).standard_normal((count, truth.size)))
        sampler = emcee.EnsembleSampler(count, truth.size, function)
        start = np.abs(start) * np.sign(truth + 1e-300)
        return timed_rate(
            (steps + 1) * count,
            lambda: sampler.run_mcmc(start, steps, skip_initial_state_check=True),
        )

    def ours(steps: int) -> tuple[float, float]:
        course = ready.course
        return timed_rate(
            steps * count * len(course.start),
            lambda: walk_all(executor, ready.target, course.start, steps, course.jumps),
        )

    ours(20)
    plain(independent, 3)
    found = np.array([(ours(60), plain(independent, 30), plain(full, 15)) for _ in range(3)])
    own, one, both = np.median(found, axis=0)
    outcome.say("## Evaluations of the log-probability per second, emcee included")
    outcome.table(
        ("", "per second", "ours is faster by", "per second of CPU", "ours is faster by"),
        [
            (name, f"{z[0]:.0f}", times(own[0], z[0]), f"{z[1]:.0f}", times(own[1], z[1]))
            for name, z in (
                ("ours, Σ, all walkers in compiled calls, 16 parameters", own),
                ("NumPy, one walker at a time, Σ solved", both),
                ("NumPy, one walker at a time, independent noise on all points", one),
            )
        ],
    )
    outcome.say(
        "Medians of three alternating measurements on two cores, which ours uses both.  NumPy's",
        "function is that of `peers.py`, with everything that depends on the test alone computed",
        "once a test.  Target: ≥ 20.",
    )
    for k, unit in enumerate(("s", "cpu_s")):
        outcome.numbers[f"rates_per_{unit}"] = {
            "ours": own[k], "numpy_sigma": both[k], "numpy": one[k],
        }  # fmt: skip


def timed_rate(made: int, work: Callable[[], object]) -> tuple[float, float]:
    """Evaluations a second, and a second of CPU."""
    cpu, wall = time.process_time(), time.perf_counter()
    work()
    return made / (time.perf_counter() - wall), made / (time.process_time() - cpu)


def times(ours: float, theirs: float) -> str:
    """How much faster ours is; nothing for itself."""
    return "" if ours == theirs else f"{ours / theirs:.0f}"


def compare_moves(ready: Ready, outcome: Outcome, steps: int) -> None:
    """Autocorrelation times of the same posterior under emcee's moves and under ours."""
    start, jump = ready.course.start[0], ready.course.jumps[0]
    single = jump_fitted(jump.draw(ONE_DENSITY, np.random.default_rng(5)))
    kinds = (
        ("stretch", [(StretchMove(), 1.0)]),
        ("differential evolution", moves(None)),
        ("the same with emcee's snooker (wrong)", [(DEMove(), 0.8), (DESnookerMove(), 0.2)]),
        ("the same with jumps to one t density", moves(single)),
        (f"ours: the same with jumps to a mixture of {jump.weight.size}", moves(jump)),
    )
    rows = []
    for name, listed in kinds:
        count, n = start.u.shape
        sampler = emcee.EnsembleSampler(count, n, ready.target, moves=listed, vectorize=True)
        sampler.random_state = random_state(11, 0).as_tuple()
        sampler.run_mcmc(start.u, steps, skip_initial_state_check=True)
        chain = sampler.get_chain(discard=steps // 5)
        tau = integrated_time(chain, quiet=True, tol=0)
        accepted = f"{sampler.acceptance_fraction.mean():.2f}"
        rows.append((name, f"{np.median(tau):.0f}", f"{tau.max():.0f}", accepted))
    outcome.say("## Moves")
    outcome.table(("moves", "median τ, steps", "largest τ", "accepted"), rows)
    outcome.say(f"One ensemble of {len(start.u)} walkers, {steps} steps from the same warm start.")
    outcome.numbers["moves"] = {row[0]: float(row[2]) for row in rows}


def compress(
    fit: Fit,
    loops: Loops,
    errors: ErrorModel,
    place: np.ndarray,
    prior: Prior,
    posterior: Posterior,
    outcome: Outcome,
) -> None:
    """Reweight the draws with the likelihood of all points of all loops."""
    u = posterior.coordinates.reshape(-1, posterior.coordinates.shape[2])
    some = u[np.linspace(0, len(u) - 1, REWEIGHTED).astype(int)]
    compressed = exact_log_likelihood(prior, errors, some, doubt_of(prior.coordinates, errors))
    rows = [row("few numbers instead of 15 harmonics", posterior.compression)]
    for name, points, harmonics in (
        ("15 harmonics instead of 60", POINTS, 60),
        ("15 harmonics instead of all", POINTS, POINTS // 2 - 1),
    ):
        finer = finer_errors(fit, loops, errors, place, points, harmonics)
        doubt = doubt_of(prior.coordinates, finer)
        ratio = np.concatenate(
            [exact_log_likelihood(prior, finer, part, doubt) for part in np.array_split(some, 8)]
        )
        rows.append(row(name, compression_error(some, ratio - compressed)))
    outcome.say("## Compression")
    head = ("what is compressed", "largest shift of a mean, sd", "largest change of an sd", "ESS")
    outcome.table(head, rows)
    outcome.say(
        f"{REWEIGHTED} draws reweighted with the likelihood without that compression (the first",
        "row: 1000).  ESS: effective draws left of them.  Bounds: 0.02 and 2 %.  Where few of the",
        "draws are left, the numbers only say that the posteriors differ.",
    )
    outcome.numbers["compression"] = {
        r[0]: [float(r[1]), float(r[2].rstrip(" %")) / 100] for r in rows
    }


def row(name: str, found: CompressionError) -> tuple[str, str, str, str]:
    return name, f"{found.mean:.5f}", f"{100 * found.sd:.3f} %", f"{found.draws:.0f}"


if __name__ == "__main__":
    main()
