r"""What limits profiles under Σ where laws are wrong: Σ, or that it has errors to first order.

The same profiles with the covariance that the generator's own random laws have, and linearised
about the most probable errors g of the laws instead of about none:

    F(u, g) ≈ F(u, ĝ) + D(û, ĝ) (g − ĝ),     ĝ = s² K_c Dᵀ Σ⁻¹ (y − F(û, ĝ) + D ĝ)

û and ĝ are found in turns.  Only a study can do the first; the second would cost a simulation of
its own for every test.
"""

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import Any, Final

# Matrices are small: threads of BLAS only fight with JAX's own (REML 20 × slower on two busy cores)
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from interval_campaign import PROGRAM, fitted
from interval_rows import MISFITS, Interval, Measured, row_of, say_shares, study
from jaxtyping import Array, Float
from outcome import Outcome

from sysid.data.loops import Loops
from sysid.identification.result import Fit
from sysid.likelihood.batches import BATCH, by_batches, in_batches
from sysid.likelihood.discrepancy import LAWS, Covariance, Sizes
from sysid.likelihood.discrepancy_parts import rate_of
from sysid.likelihood.gls import gauss_newton
from sysid.likelihood.kernel import places_of
from sysid.likelihood.law_directions import stretched
from sysid.likelihood.observed import Observed
from sysid.models.coordinates import AbstractCoordinates
from sysid.motion.motion import Motion
from sysid.rig.trial_campaign import TrialDesign
from sysid.uncertainty.error_model import ErrorModel, errors_at
from sysid.uncertainty.profiles import profiles
from sysid.uncertainty.propagated import by_eq_11
from sysid.uncertainty.sample import observed_of

KINDS: Final = {
    "eq_11": "values of Eq. 11 under Σ, along profiles (the card's)",
    "found": "profiles under Σ by REML, as drawn",
    "found_about": "the same, about the most probable laws",
    "known": "profiles under the generator's own Σ",
    "known_about": "the same, about the most probable laws",
}
LENGTH: Final = 0.6
"""Correlation length of the generator's laws, parts of the ranges."""
RANGES: Final = (np.log(75.0 / 2.5), np.log(15.0 / 0.1), 0.4)
"""Of ln A, ln f and current, A, as `rig.trial_misfit` has them."""
TINY: Final = 1e-9
"""Added to the diagonal of K_c, which is smooth to rounding."""
TURNS: Final = 8
"""Of û and ĝ."""


@dataclass(frozen=True)
class Departed(Observed):
    """Measured loops beside a model whose laws err by known factors.

    Attributes:
        errors: [p, L] g, relative errors of `LAWS`; F(û, ĝ) − D ĝ is what the model's force is.
    """

    errors: Float[np.ndarray, "law loop"]

    def look(
        self, coordinates: AbstractCoordinates[Any], u: Float[np.ndarray, " n"]
    ) -> tuple[Float[np.ndarray, "loop m"], Float[np.ndarray, "loop m n"]]:
        """Residual and Jacobian at u."""
        force, jacobian = self.beside_laws(partial(_forces, coordinates, jnp.asarray(u)))
        return self.measured - force, jacobian

    def beside_laws(self, program: Callable[[Motion, Array, Array], Any]) -> Any:
        """What a program of motion, errors of the laws [L, p] and columns makes of the tests."""
        filled = np.concatenate(
            [self.errors, np.repeat(self.errors[:, -1:], -self.tests % BATCH, axis=1)], axis=1
        )
        laws = in_batches(filled.T)
        found = by_batches(
            lambda some, errors: program(some, errors, self.columns), self.batches, laws
        )
        return jax.tree.map(lambda z: z[: self.tests], found)


@eqx.filter_jit
def _forces(
    coordinates: AbstractCoordinates[Any], u: Array, motion: Motion, laws: Array, columns: Array
) -> tuple[Array, Array]:
    def force(z: Array) -> Array:
        return _with_laws(coordinates, z, motion, laws) @ columns

    def along(direction: Array) -> tuple[Array, Array]:
        return jax.jvp(force, (u,), (direction,))

    return jax.vmap(along, out_axes=(None, 2))(jnp.eye(u.size))


@eqx.filter_jit
def _changes(
    coordinates: AbstractCoordinates[Any], u: Array, motion: Motion, laws: Array, columns: Array
) -> Array:
    """[L, p, m] D."""

    def along(direction: Array) -> Array:
        each = jnp.broadcast_to(direction, laws.shape)
        changed = partial(_with_laws, coordinates, u, motion)
        return jax.jvp(changed, (laws,), (each,))[1] @ columns

    return jax.vmap(along, out_axes=1)(jnp.eye(len(LAWS)))


def _with_laws(
    coordinates: AbstractCoordinates[Any], u: Array, motion: Motion, laws: Array
) -> Array:
    factors = (1.0 + laws).T[:, :, None]
    return factors[0] * stretched(coordinates.valve(u), factors[1:]).force(motion)


def known(errors: ErrorModel, design: TrialDesign) -> ErrorModel:
    """With the covariance of the generator's rig and laws.

    Args:
        errors: By REML.
        design: Of the campaign, with the size of the errors of the laws.
    """
    loops = errors.observed.loops
    place = places_of(
        loops.amplitude, loops.frequency, loops.current, loops.temperature, 1.0
    )[:, :3]  # fmt: skip
    place /= LENGTH * np.array(RANGES)
    kernel = np.exp(-0.5 * np.sum((place[:, None] - place[None]) ** 2, axis=2))
    kernel += TINY * np.eye(len(kernel))
    sizes = Sizes(
        gain=design.gain_sd, offset=design.offset_sd, delay=design.delay_sd,
        scale=np.sqrt(2.0) * design.misfit,  # it errs in F_t and in C_i, and both scale the force
        width=design.misfit, growth=design.misfit,
    )  # fmt: skip
    observed = replace(errors.observed, parts=replace(errors.observed.parts, kernel=kernel))
    return replace(
        errors, observed=observed, sizes=sizes, covariance=Covariance(observed.parts, sizes)
    )


def settled(fit: Fit, errors: ErrorModel) -> ErrorModel:
    """The most probable parameters under Σ."""
    look = partial(errors.observed.look, fit.coordinates)
    gls = gauss_newton(look, errors.u, errors.covariance)
    return replace(errors, u=gls.u, information=gls.information)


def about_laws(fit: Fit, errors: ErrorModel) -> ErrorModel:
    """Linearised about the most probable errors of the laws, found in turns with the parameters."""
    plain, coordinates = errors.observed, fit.coordinates
    sizes = np.array([getattr(errors.sizes, name) for name in LAWS])
    own = {f.name: getattr(plain, f.name) for f in fields(plain)}
    here = Departed(**own, errors=np.zeros((len(LAWS), plain.tests)))
    for _ in range(TURNS):
        at = jnp.asarray(errors.u)
        D = np.moveaxis(here.beside_laws(partial(_changes, coordinates, at)), 1, 0)
        force, _ = here.beside_laws(partial(_forces, coordinates, at))
        rate = rate_of(force, plain.loops, plain.basis)
        parts = replace(plain.parts, laws=D, force=force, rate=rate)
        shift = np.einsum("plm,pl->lm", D, here.errors)
        here = replace(here, parts=parts, measured=plain.measured + shift)
        covariance = Covariance(parts, errors.sizes)
        gls = gauss_newton(partial(here.look, coordinates), errors.u, covariance)
        errors = replace(
            errors, observed=here, covariance=covariance, u=gls.u, information=gls.information
        )
        told = covariance.weighted(gls.residual[:, :, None])[:, :, 0]
        g = sizes[:, None] ** 2 * (parts.kernel @ np.einsum("plm,lm->lp", D, told)).T
        here = replace(here, errors=g)
    return errors


def main() -> None:
    study(
        __doc__, "known_laws", campaigns=30, first_seed=61_000_100, work=work, program=PROGRAM,
        page=make_page,
    )  # fmt: skip


def work(name: str) -> dict[str, Any]:
    """One campaign by its name: what its intervals say of the truth."""
    return row_of(name, intervals, PROGRAM)


def intervals(seed: int, percent: float) -> Measured:
    """All intervals of one campaign's free parameters, the truth, the laws' error and the time."""
    trial, fit, design = fitted(seed, percent)
    begin = time.perf_counter()
    found = errors_at(fit, observed_of(fit, trial.loops))
    generated = known(found, design)
    likelihoods = {
        "found": found, "found_about": about_laws(fit, found),
        "known": settled(fit, generated), "known_about": about_laws(fit, generated),
    }  # fmt: skip
    free = fit.coordinates.free
    ends: dict[str, dict[str, Interval]] = {"eq_11": card_of(fit, trial.loops, found)}
    for kind, errors in likelihoods.items():
        ends[kind] = {
            p.symbol: (p.low, p.high, p.determined) for p in profiles(fit, errors, threads=1)
        }
    took = time.perf_counter() - begin
    return Measured(ends, {s: trial.truth.parameters[s] for s in free}, design.misfit, took)


def card_of(fit: Fit, loops: Loops, errors: ErrorModel) -> dict[str, Interval]:
    """The card's intervals of the free parameters."""
    free = fit.coordinates.free
    told = by_eq_11(fit, loops, errors).parameters
    return {p.symbol: (p.low, p.high, p.identified) for p in told if p.symbol in free}


def make_page(rows: Sequence[dict[str, Any]]) -> Outcome:
    """Shares of every kind of interval."""
    outcome = Outcome("known_laws", "What limits profiles under Σ")
    outcome.say(
        'Campaigns as in `coverage.py`.  "About the most probable laws": Σ has errors of the',
        "valve's laws to first order about the fitted laws, or about what they most probably are.",
        "The generator's own Σ has the sizes and the smoothness that errors of rig and laws were",
        "drawn with.",
    )
    for misfit in MISFITS:
        say_shares(outcome, rows, KINDS, misfit)
    outcome.say(
        "Intervals of shares: bootstrap over campaigns, whose parameters share their errors."
    )
    return outcome


if __name__ == "__main__":
    main()
