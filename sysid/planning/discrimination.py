r"""How surely one more test would tell two explanations apart.

If a is right, the test gives F_a, and b is fitted again to the old tests and this one:

    Δ = min over θ of ‖F_a − F_b(θ)‖² under Σ, beside what the old tests say of θ
      = dᵀ (Σ + J C Jᵀ)⁻¹ d,   d = F_a − F_b,
      = dᵀΣ⁻¹d − gᵀ (1 + RᵀJᵀΣ⁻¹JR)⁻¹ g,   g = RᵀJᵀΣ⁻¹d,   RRᵀ = C,

J the change of F_b with its parameters and C their covariance by the old tests.  The logarithm of
the Bayes factor for a is then expected to be Δ/2, and that to base 10 Δ/(2 ln 10).  Σ is that of a
single test: its noise, the rig's gain, offset and delay, and errors of the model's laws, as large
as the diagnosis found them.

Several tests are told by one θ: dᵀΣ⁻¹d, g and RᵀJᵀΣ⁻¹JR add up, Δ does not.  Two tests whose
difference the same change of b's parameters takes away say hardly more than one.

Source:
    G. Buzzi-Ferraris, P. Forzatti, Chem. Eng. Sci. 38 (1983) 225: differences of rival models
    weighed against the variance of their predictions.
"""

from dataclasses import dataclass
from typing import Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from sysid.diagnosis.alternatives import Alternative
from sysid.effects.base import AbstractChannelEffect, AbstractForceEffect
from sysid.likelihood.compress import harmonic_basis
from sysid.likelihood.discrepancy import LAWS, Covariance, Parts, Sizes
from sysid.likelihood.discrepancy_parts import derivative
from sysid.likelihood.law_directions import law_directions
from sysid.models.base import AbstractModel
from sysid.models.damper import Damper
from sysid.motion.motion import Motion
from sysid.parameters import build, specs
from sysid.parameters import values as vector_of
from sysid.planning.candidates import POINTS, Candidate, motion_of, second_cycle

OF_THE_RIG: Final = frozenset({"fixture_inertia"})
"""Forces in parallel that stay when the damper is taken out; those of the channel do, too."""
BASIS: Final = harmonic_basis(POINTS)


class Course(eqx.Module):
    """Force of a damper as a function of its free parameters.

    Attributes:
        damper: As fitted.
        free: [k] what is added to all parameters of valve and effects for each free one.
    """

    damper: Damper
    free: Float[Array, "every k"]

    def at(self, change: Float[Array, " k"]) -> Damper:
        """The damper with its free parameters changed."""
        moved = self.free @ change
        valve = self.damper.valve
        first = len(specs(valve))
        effects = []
        new = build(valve, vector_of(valve) + moved[:first])
        for effect in self.damper.effects:
            symbols = [s.symbol for s in specs(effect)]
            own = vector_of(effect) + moved[first : first + len(symbols)]
            values = [own[k] for k in range(len(symbols))]
            effects.append(
                eqx.tree_at(lambda e, s=symbols: [getattr(e, z) for z in s], effect, values)
            )
            first += len(symbols)
        return Damper(new, tuple(effects))


def course_of(one: Alternative) -> Course:
    """Of an alternative; parameters that are tied to a free one move with it."""
    damper = one.damper
    names = [s.symbol for s in specs(damper.valve)]
    for effect in damper.effects:
        names += [f"{effect.facts.id}.{s.symbol}" for s in specs(effect)]
    free = np.zeros((len(names), len(one.symbols)))
    seen: set[int] = set()
    for column, symbol in enumerate(one.symbols):
        places = [k for k, name in enumerate(names) if name == symbol and k not in seen]
        seen.add(places[0])
        free[places[0], column] = 1.0
        for follower, leader in one.ties:
            if leader == symbol:
                free[names.index(follower), column] = 1.0
    return Course(damper, jnp.asarray(free))


class RigAlone(AbstractModel):
    """What a rig records with the damper taken out: its own moving parts, and its channel.

    Attributes:
        damper: That was in it.
    """

    damper: Damper

    def force(self, motion: Motion) -> Float[Array, "*batch n"]:
        """Recorded force, N."""
        force = jnp.zeros_like(motion.velocity)
        for effect in self.damper.effects:
            if isinstance(effect, AbstractForceEffect) and effect.facts.id in OF_THE_RIG:
                force = force + effect.force(motion)
        for effect in self.damper.effects:
            if isinstance(effect, AbstractChannelEffect):
                force = effect.recorded(force, motion)
        return force


@dataclass(frozen=True)
class Seen:
    """What an alternative predicts of some tests.

    Attributes:
        force: [C, J] N, on one cycle.
        harmonics: [C, m] N.
        slopes: [C, m, k] N per unit of each free parameter.
        laws: [C, m, p] N, changes for an error of each law by one.
    """

    force: Float[np.ndarray, "test phase"]
    harmonics: Float[np.ndarray, "test m"]
    slopes: Float[np.ndarray, "test m k"]
    laws: Float[np.ndarray, "test m law"]


def predict(one: Alternative, tests: list[Candidate], temperature: float) -> Seen:
    """Predict tests of one kind.

    Args:
        one: The alternative.
        tests: [C], all of one kind.
        temperature: °C.
    """
    motion = motion_of(tests, temperature)
    return predict_on(one, motion, alone=tests[0].kind == "rod_disconnected")


def predict_on(one: Alternative, motion: Motion, *, alone: bool = False) -> Seen:
    """Predict what is recorded on motions, such as those that a rig made of what it was asked for.

    Args:
        one: The alternative.
        motion: [C, J] of one cycle of `POINTS`, or of two, of which the second counts.
        alone: The damper is not in the rig.
    """
    columns = jnp.asarray(BASIS.columns / POINTS)
    force, harmonics, slopes = _predicted(course_of(one), motion, columns, alone)
    harmonics = np.asarray(harmonics)
    laws = np.zeros((len(LAWS), *harmonics.shape))
    if not alone:
        bent = law_directions(one.damper, motion, _on_second(motion, columns))
        laws = np.concatenate([harmonics[None], np.asarray(bent)])
    return Seen(np.asarray(force), harmonics, np.asarray(slopes), np.moveaxis(laws, 0, 2))


@eqx.filter_jit
def _predicted(course: Course, motion: Motion, columns: Array, alone: bool) -> tuple[Array, ...]:
    def force(change: Float[Array, " k"]) -> Float[Array, "test phase"]:
        damper = course.at(change)
        model = RigAlone(damper) if alone else damper
        return second_cycle(motion, model.force(motion))

    here = jnp.zeros(course.free.shape[1])
    value, push = jax.linearize(force, here)
    slopes = jax.vmap(lambda e: push(e) @ columns)(jnp.eye(here.size))
    return value, value @ columns, jnp.moveaxis(slopes, 0, 2)


def _on_second(motion: Motion, columns: Array) -> Array:
    """Columns for everything that was simulated, of which only one cycle counts."""
    before = motion.velocity.shape[-1] - columns.shape[0]
    return jnp.concatenate([jnp.zeros((before, columns.shape[1])), columns]) if before else columns


@dataclass(frozen=True)
class Apart:
    """What Δ is made of, in one test or in several together.

    Attributes:
        whole: [...] dᵀΣ⁻¹d.
        shared: [..., r] g.
        known: [..., r, r] RᵀJᵀΣ⁻¹JR.
    """

    whole: Float[np.ndarray, "..."]
    shared: Float[np.ndarray, "... r"]
    known: Float[np.ndarray, "... r r"]

    def distance(self) -> Float[np.ndarray, "..."]:
        """Δ."""
        kept = np.eye(self.shared.shape[-1]) + self.known
        taken = np.linalg.solve(kept, self.shared[..., None])[..., 0]
        return np.maximum(self.whole - np.sum(self.shared * taken, axis=-1), 0.0)

    def beside(self, other: "Apart") -> "Apart":
        """Both together, for the same pair the same way round."""
        return Apart(self.whole + other.whole, self.shared + other.shared, self.known + other.known)

    def at(self, place: int) -> "Apart":
        """Of one of several tests."""
        return Apart(self.whole[place], self.shared[place], self.known[place])


def weigh(
    right: Seen,
    other: Seen,
    covariance: Float[np.ndarray, "k k"],
    sizes: Sizes,
    noise: float,
    frequency: Float[np.ndarray, " test"],
) -> Apart:
    """What each test says, [C]; nothing where a model is not finite.

    Args:
        right: What the alternative predicts that is right.
        other: What the one predicts that is fitted again.
        covariance: Of its free parameters.
        sizes: Of the parts of Σ.
        noise: N, of each coefficient.
        frequency: [C] Hz.
    """
    numbers = (right.harmonics, other.harmonics, other.slopes, other.laws)
    fine = np.all([np.isfinite(np.reshape(one, (len(one), -1))).all(axis=1) for one in numbers], 0)
    rank = len(covariance)
    found = Apart(
        np.zeros(fine.size), np.zeros((fine.size, rank)), np.zeros((fine.size, rank, rank))
    )
    if not fine.any():
        return found
    d = (right.harmonics - other.harmonics)[fine]
    slopes = other.slopes[fine] @ _root(covariance) if rank else other.slopes[fine, :, :0]
    both = np.concatenate([slopes, d[:, :, None]], axis=2)
    seen = errors_of(other, sizes, noise, frequency, fine).weighted(both)
    gram = np.einsum("cmi,cmj->cij", both, seen)
    found.whole[fine] = gram[:, -1, -1]
    found.shared[fine] = gram[:, :-1, -1]
    found.known[fine] = gram[:, :-1, :-1]
    return found


def errors_of(
    seen: Seen,
    sizes: Sizes,
    noise: float,
    frequency: Float[np.ndarray, " test"],
    which: Bool[np.ndarray, " test"],
) -> Covariance:
    """Σ of some tests, each by itself: their errors of the laws share nothing (K_c = 1).

    Args:
        seen: What a model predicts of them.
        sizes: Of the parts of Σ.
        noise: N, of each coefficient.
        frequency: [C] Hz.
        which: [C] those that are wanted.
    """
    force = seen.harmonics[which]
    return Covariance(
        Parts(
            noise=np.full(len(force), noise),
            force=force,
            rate=2.0 * np.pi * frequency[which, None] * derivative(force, BASIS),
            scale=np.sqrt(np.sum(force**2, axis=1)),
            order=BASIS.order,
            kernel=np.eye(len(force)),
            laws=np.moveaxis(seen.laws[which], 2, 0),
        ),
        sizes,
    )


def _root(covariance: Float[np.ndarray, "k k"]) -> Float[np.ndarray, "k r"]:
    """R with RRᵀ = C, of whatever rank, parameters being of any magnitude."""
    size = np.sqrt(np.maximum(np.diagonal(covariance), 0.0))
    unit = np.divide(1.0, size, out=np.zeros_like(size), where=size > 0.0)
    values, vectors = np.linalg.eigh(covariance * unit[:, None] * unit[None, :])
    return size[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))
