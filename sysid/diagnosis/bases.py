"""Which base model: every admissible one is fitted, the best by held-out error is extended."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from sysid.data.loops import Loops
from sysid.data.supply import same_current
from sysid.diagnosis.evidence import Evidence, gather
from sysid.diagnosis.held_out import errors_in_blocks
from sysid.diagnosis.plain import plainly_fitted, unweighted
from sysid.diagnosis.state import State
from sysid.errors import FitError
from sysid.identification.conditions import conditions
from sysid.identification.families import family
from sysid.identification.fit import fit_loops
from sysid.identification.multistart import MAX_WAVES
from sysid.identification.result import Fit
from sysid.likelihood.late import straightened_beside
from sysid.likelihood.smoothness import smoothness_and_sizes
from sysid.models.coordinates import valve_at
from sysid.models.damper_coordinates import DamperCoordinates
from sysid.motion.history import RunHistory

BASES: Final = (
    ("generalized", "symmetric"),
    ("tanh", None),
    ("dahl", None),
    ("bouc_wen", None),
)
"""Bases that are tried when none is asked for: models that fit in seconds, and of the generalised
one the variant that leaves asymmetry to the effects."""
SWEPT: Final = ("lumped", None)
"""Tried beside them on a sweep over temperature: its laws are lines in temperature."""
SWEEP: Final = 30.0
"""K at least between tests of one excitation and current in a sweep over temperature.  Where no
setting is repeated, temperatures scatter by as much and are none."""
REPEATED: Final = 0.5
"""Part of the tests that have such a repeat in a sweep."""
LAST_RESORT: Final = (
    ("generalized", "asymmetric"),
    ("carreau", None),
    ("modified_bouc_wen", None),
)
"""Tried beside them where all of them are wrong altogether: the first absorbs offsets and one-sided
effects that are better called by their name, the second almost any law in current and speed; the
third integrates a stiff state, which takes many times as long as any other."""
WAVES: Final = {"modified_bouc_wen": 1}
"""Waves of starts at most, where more cannot be afforded: on data of its own the first suffices."""
ADMISSIBLE: Final = 1.5
"""A base is admissible if its error is at most so many times that of the best one."""
EXTENDED: Final = 2
"""Bases that are extended at most."""
DOUBTFUL: Final = 0.03
"""Error (`Base.in_sample`) from which a last resort with memory is not believed to be the damper's
own model: its state may only stand in for springs, play and leaks."""
COARSE_FOLDS: Final = 4


@dataclass(frozen=True)
class Base:
    """A base model, fitted.

    Attributes:
        fit: To all tests.
        evidence: The campaign, with rig errors acting on this model's force.
        free: Fitted by least squares with weights 1/max|F|, for free runs.
        in_sample: Mean over tests of RMSE/max|F|, what is constant through a test left out: a
            preload says nothing of the laws.
        held_out: [L] RMSE/max|F|, each test predicted without its condition.
        shapes: [L] the same without what is constant through a test.
    """

    fit: Fit
    evidence: Evidence
    free: State
    in_sample: float
    held_out: Float[np.ndarray, " loop"]
    shapes: Float[np.ndarray, " loop"]

    @property
    def memoryless(self) -> bool:
        """Its force at an instant follows from the motion at that instant alone."""
        return family(self.fit.model).memoryless

    @property
    def doubtful(self) -> bool:
        """A last resort with memory that leaves too much to be the damper's own."""
        last = (self.fit.model, None) in LAST_RESORT
        return last and not self.memoryless and self.in_sample > DOUBTFUL

    @property
    def error(self) -> float:
        """Mean held-out error."""
        return float(self.held_out.mean())

    @property
    def error_of_shapes(self) -> float:
        """Mean held-out error of shapes, by which bases are ranked.

        Some bases have a static force, others leave it to effects: that says nothing of their laws.
        """
        return float(self.shapes.mean())


def fit_bases(
    loops: Loops,
    models: Sequence[tuple[str, str | None]],
    *,
    history: RunHistory | None = None,
    seed: int,
    progress: Callable[[str], None],
) -> tuple[Base, ...]:
    """Fit every base; best first.

    Bases that already fit much worse are predicted in four blocks of conditions instead of
    condition by condition.

    Args:
        loops: L tests.
        models: (name, variant) of the bases.
        history: Of the L tests, if their order is known.
        seed: Of the starts.
        progress: Called with a line a base.

    Raises:
        FitError: No base can be fitted.
    """
    fitted, refused = [], None
    for model, variant in models:
        try:
            fit = fit_loops(
                loops, model=model, variant=variant, weights="peak", seed=seed,
                max_waves=WAVES.get(model, MAX_WAVES),
            )  # fmt: skip
        except FitError as error:
            refused = error
            continue
        progress(f"{model}: error {100 * fit.mean_nrmse:.2f} % in sample")
        fitted.append(fit)
    if not fitted:
        raise refused or FitError("no base model was given")
    points = [family(fit.model, fit.variant).points_for(loops) for fit in fitted]
    on = {p: gather(loops, history, p) for p in set(points)}
    plain = [_plainly(on[p], fit) for p, fit in zip(points, fitted, strict=True)]
    best = min(p.in_sample for p in plain)
    bases = [_predicted(p, fine=p.in_sample <= ADMISSIBLE * best) for p in plain]
    return by_rank(bases)


def by_rank(bases: Iterable[Base]) -> tuple[Base, ...]:
    """Best first."""
    return tuple(sorted(bases, key=lambda b: b.error_of_shapes))


@dataclass(frozen=True)
class _Plain:
    """A base fitted for free runs, before it has predicted anything."""

    fit: Fit
    evidence: Evidence
    free: State
    in_sample: float


def _plainly(evidence: Evidence, fit: Fit) -> _Plain:
    coordinates = DamperCoordinates(fit.coordinates, ())
    first = valve_at(coordinates, jnp.asarray(fit.u))
    own = evidence.beside(first, evidence.residual(coordinates, fit.u))
    free = plainly_fitted(unweighted(own), coordinates, fit.u)
    damper = valve_at(coordinates, jnp.asarray(free.u))
    return _Plain(fit, own, free, float(own.errors(damper, offset=False).mean()))


def _predicted(plain: _Plain, *, fine: bool) -> Base:
    evidence = unweighted(plain.evidence)
    held_out, shapes = errors_in_blocks(evidence, plain.free, None if fine else COARSE_FOLDS)
    return Base(plain.fit, plain.evidence, plain.free, plain.in_sample, held_out, shapes)


def usual_bases(loops: Loops) -> tuple[tuple[str, str | None], ...]:
    """Bases, (name, variant), to try on a campaign of L tests when none is asked for."""
    condition, current, warm = conditions(loops), np.abs(loops.current), loops.temperature
    same = condition[:, None] == condition
    same &= np.abs(current[:, None] - current) <= same_current(float(current.max()))
    repeated = (same & (np.abs(warm[:, None] - warm) >= SWEEP)).any(axis=1)
    return (*BASES, SWEPT) if repeated.mean() > REPEATED else BASES


def admissible(bases: Sequence[Base]) -> tuple[Base, ...]:
    """Bases good enough to be extended, best first."""
    least = bases[0].error_of_shapes
    return tuple(b for b in bases if b.error_of_shapes <= ADMISSIBLE * least)


def extendable(bases: Sequence[Base], *, coarse: bool) -> tuple[Base, ...]:
    """Bases that are extended, best first.

    Where all bases are wrong altogether, one without memory is taken, though others may err less by
    themselves: a state that follows travel stands in for springs, play and leaks.  One is all that
    there is time for.  Where such a state is the last resort, and leaves too much to be the
    damper's own, one without memory is extended before it (`outdone`).
    """
    admitted = admissible(bases)
    if coarse:
        return tuple(b for b in admitted if b.memoryless)[:1] or admitted[:1]
    chosen = admitted[:EXTENDED]
    if bases[0].doubtful and not any(b.memoryless for b in chosen):
        chosen = (*chosen, *tuple(b for b in bases if b.memoryless)[:1])
    return tuple(sorted(chosen, key=lambda b: b.doubtful))


def outdone(base: Base, least: float) -> bool:
    """A base is not worth extending.

    What a doubtful last resort is better at is what effects are for.  Where another base with its
    effects already predicts unseen tests better than it does, nothing is left that speaks for it,
    and with its own effects, which take many times as long to find, it could at best say the same.

    Args:
        base: A base.
        least: Smallest held-out error of the bases extended so far.
    """
    return base.doubtful and least <= base.error


def with_error_models(bases: Sequence[Base]) -> tuple[Base, ...]:
    """The same, those that are extended with smooth errors of laws and delays that act as in Σ.

    Errors of their laws are as smooth as is most probable, and delays act to first order (`late`).
    """
    extended = {id(b) for b in extendable(bases, coarse=False)}
    return tuple(replace(b, evidence=_seen_beside(b)) if id(b) in extended else b for b in bases)


def _seen_beside(base: Base) -> Evidence:
    coordinates, u = base.free.coordinates, np.asarray(base.free.u)
    evidence, sizes = straightened_beside(base.evidence, coordinates, u)
    return smoothness_and_sizes(evidence, coordinates, u, sizes)[0]
