"""The same posterior by emcee and by NUTS: do they agree, and which is faster."""

import argparse
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from marginals import STATISTICS, agreement, effective
from outcome import Outcome

from sysid.identification.families import family
from sysid.identification.fit import fit_loops
from sysid.identification.result import Fit
from sysid.rig.trial_campaign import make_trial
from sysid.rig.trial_design import TrialDesign
from sysid.uncertainty.chain import draws_of, grow
from sysid.uncertainty.convergence import convergence
from sysid.uncertainty.error_model import ErrorModel
from sysid.uncertainty.prior import prior_of
from sysid.uncertainty.sample import errors_of
from sysid.uncertainty.target import Target, parameters_at
from sysid.uncertainty.warm_up import Ready, warm_up

SEED, MISFIT, POINTS = 3, 0.02, 360
CHAINS, WARM_UP, DRAWS = 4, 1000, 1000


@dataclass(frozen=True)
class Run:
    """What a sampler did.

    Attributes:
        u: [chain, draw, n].
        before: s of warm-up, compiling included.
        sampling: s.
        evaluations: Of the log-probability (emcee) or of it and its slopes (NUTS) while sampling.
        words: What is to be known besides.
    """

    u: np.ndarray
    before: float
    sampling: float
    evaluations: int
    words: str


def by_nuts(target: Target, start: np.ndarray, warm: int, draws: int, seed: int = 0) -> Run:
    """Draw from a target with NumPyro's NUTS, one chain after the other.

    Args:
        target: Log-probability.
        start: [chain, n] places.
        warm: Steps in which step and mass matrix adapt.
        draws: Steps after them.
        seed: Of the chains.
    """
    from numpyro.infer import MCMC, NUTS  # pyright: ignore[reportMissingImports] an optional extra

    mcmc = MCMC(
        NUTS(potential_fn=lambda u: -target.at(u), dense_mass=True),
        num_warmup=warm, num_samples=draws, num_chains=len(start), chain_method="sequential",
        progress_bar=False,
    )  # fmt: skip
    keys = jax.random.split(jax.random.PRNGKey(seed), len(start))
    wall = time.perf_counter()
    mcmc.warmup(keys, init_params=jnp.asarray(start))
    before, wall = time.perf_counter() - wall, time.perf_counter()
    mcmc.run(keys, extra_fields=("num_steps", "diverging"))
    u = np.asarray(mcmc.get_samples(group_by_chain=True))
    sampling = time.perf_counter() - wall
    fields = mcmc.get_extra_fields()
    steps, lost = int(np.sum(fields["num_steps"])), int(np.sum(fields["diverging"]))
    return Run(u, before, sampling, steps, f"{lost} divergent transitions")


def by_emcee(errors: ErrorModel, fit: Fit, budget: float, seed: int = 0) -> tuple[Run, Ready]:
    """The sampler of `sysid fit`, to its own end."""
    prior = prior_of(fit.coordinates, errors.u)
    names = [spec.symbol for spec in prior.declared]
    with ThreadPoolExecutor(2) as executor:
        wall = time.perf_counter()
        memoryless = family(fit.model).memoryless
        ready = warm_up(prior, errors, executor, seed, lambda line: None, memoryless=memoryless)
        before, wall = time.perf_counter() - wall, time.perf_counter()
        blocks, _, message = grow(
            ready.course,
            lambda u: convergence(u, names),
            executor,
            deadline=time.monotonic() + budget,
        )
        sampling = time.perf_counter() - wall
    u = np.moveaxis(draws_of(blocks), 2, 1)  # each walker is a chain
    u = u.reshape(-1, *u.shape[2:])
    return Run(u, before, sampling, u.shape[0] * u.shape[1], message), ready


def dispersed(run: Run, chains: int, seed: int = 1) -> np.ndarray:
    """Places to start at that are wider than the posterior, [chain, n]."""
    flat = run.u.reshape(-1, run.u.shape[2])
    root = np.linalg.cholesky(np.cov(flat, rowvar=False))
    z = np.random.default_rng(seed).standard_normal((chains, flat.shape[1]))
    return np.median(flat, axis=0) + 1.5 * z @ root.T


def parameters(target: Target, u: np.ndarray) -> np.ndarray:
    """Of chains [chain, draw, n], in their units."""
    return parameters_at(target.prior, u.reshape(-1, u.shape[2])).reshape(u.shape)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few draws, nothing written")
    quick = parser.parse_args().quick
    trial = make_trial(
        SEED, (), design=TrialDesign(fewest=110, most=110, points=POINTS, misfit=MISFIT)
    )
    fit = fit_loops(trial.loops)
    errors = errors_of(fit, trial.loops, "full")
    emcee, ready = by_emcee(errors, fit, 120.0)
    target = ready.target
    nuts = by_nuts(target, dispersed(emcee, CHAINS), *((200, 200) if quick else (WARM_UP, DRAWS)))
    outcome = Outcome("nuts", "The posterior of 16 parameters by emcee and by NUTS")
    outcome.say(
        f"{len(trial.loops.ids)} loops of {POINTS} points on the virtual rig, laws {MISFIT:.0%}",
        "wrong, likelihood with the full covariance Σ.  Both draw from the same reduced target",
        "(`sysid/uncertainty/target.py`) in solver coordinates; NUTS is NumPyro's, with a dense",
        f"mass matrix, {len(nuts.u)} chains one after the other from places wider than the",
        "posterior.",
    )
    rows, numbers = [], {}
    for name, run in (("emcee, 4 ensembles, two threads", emcee), ("NUTS", nuts)):
        bulk, tail = effective(run.u)
        rates = bulk / run.sampling, bulk / (run.sampling + run.before)
        rows.append(
            (
                name, f"{run.before:.0f}", f"{run.sampling:.0f}", f"{run.evaluations:,}",
                f"{bulk:.0f}", f"{tail:.0f}", f"{rates[0]:.0f}", f"{rates[1]:.0f}", run.words,
            )
        )  # fmt: skip
        numbers[name.split(",")[0]] = {
            "warm_up_s": run.before, "sampling_s": run.sampling, "evaluations": run.evaluations,
            "least_bulk_ess": bulk, "least_tail_ess": tail, "ess_per_s": rates[0],
            "ess_per_s_with_warm_up": rates[1],
        }  # fmt: skip
    outcome.table(
        (
            "sampler", "warm-up s, compiling included", "sampling s", "evaluations",
            "least bulk ESS", "least tail ESS", "bulk ESS per s of sampling",
            "per s, warm-up included", "",
        ),
        rows,
    )  # fmt: skip
    outcome.say(
        "Evaluations of NUTS are of the log-probability and its slopes.  The machine was shared:",
        "compare rates of this run only.",
    )
    outcome.say("## Marginals")
    for name, one, other in (
        ("solver coordinates", emcee.u, nuts.u),
        ("parameters", parameters(target, emcee.u), parameters(target, nuts.u)),
    ):
        found = agreement(one, other)
        told = "agree" if found.agrees else "DIFFER"
        outcome.say(f"{name[0].upper() + name[1:]}: {told}; {found.words()}.")
        numbers[name] = {
            "largest_z": float(np.abs(found.z).max()), "bound": found.bound,
            "rms_z": float(np.sqrt(np.mean(found.z**2))),
            "largest_difference_sd": float(np.abs(found.apart).max()), "agrees": found.agrees,
        }  # fmt: skip
    symbols = [spec.symbol for spec in target.prior.declared]
    outcome.table(
        ("z of", *STATISTICS),
        [(s, *(f"{z:.2f}" for z in found.z[:, k])) for k, s in enumerate(symbols)],
    )
    outcome.say("z: emcee minus NUTS over the standard error of the difference (Monte Carlo).")
    outcome.numbers = numbers
    outcome.finish(keep=not quick)


if __name__ == "__main__":
    main()
