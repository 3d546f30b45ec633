"""Entry point: from the loops of many dampers to their models, in one batched program."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields
from typing import Final

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from sysid.data.loops import Loops
from sysid.fleet.bottom import to_the_bottom
from sysid.fleet.evidence import Evidence, basins, evidence
from sysid.fleet.normal_equations import loop_columns, loop_numbers
from sysid.fleet.result import FleetFit, joined
from sysid.fleet.slots import SLOTS, Ends, walk_all
from sysid.fleet.stack import Stack, stack_loops, thinned
from sysid.fleet.starts import fleet_starts
from sysid.identification.multistart import FEW_HITS, WAVE
from sysid.identification.problem import Weights
from sysid.identification.result import Result
from sysid.models.coordinates import Reference
from sysid.models.generalized_coordinates import GeneralizedCoordinates, Variant
from sysid.parameters import values

SPREADS: Final = (0.7, 1.5, 0.3, 2.5)
"""Standard deviation of starts about the first one, wave after wave, in solver coordinates."""
MAX_WAVES: Final = 8
"""Waves of eight starts at most.  Dampers that then still have no minimum reached three times are
few, and said to be so; a single fit makes more."""
SCREEN_POINTS: Final = 24
"""Of a loop, on which starts are tried."""
COARSE, COARSE_STEPS, COARSE_DAMPING = 1e-4, 60, 1e-3
"""Relative decrease of the cost at which a start has arrived; its steps; λ of the first one."""
PASS: Final = 1024
"""Dampers that are taken together at most."""


def fit_fleet(
    fleet: Sequence[Loops],
    *,
    variant: Variant = "asymmetric",
    weights: Weights = "paper",
    starts: int = WAVE,
    max_waves: int = MAX_WAVES,
    seed: int = 0,
    threads: int = 1,
    progress: Callable[[str], None] | None = None,
) -> FleetFit:
    """Fit the generalised model to every damper of a fleet; no start value is asked.

    Minimises Eq. 11 for each damper, as `fit_loops` does for one.  All dampers go side by side
    through one compiled program; those that have arrived make room for others.

    Args:
        fleet: Loops of D dampers on one phase grid; numbers of tests and conditions may differ.
        variant: Of the generalised model.
        weights: As for `fit_loops`.
        starts: Of every damper, at least three.  Eight, all ending in one minimum, are the
            evidence that single fits ask for.
        max_waves: Waves of more starts at most, where those disagreed.
        seed: Of the scatter of starts; the same for every damper, so that the result of a damper
            does not depend on the others.
        threads: Parts of the fleet that are fitted at once.
        progress: Called with a line now and then.

    Raises:
        FitError: Phase grids differ, or a damper cannot be fitted.
        ValueError: Fewer than three starts are asked for.
    """
    if starts < FEW_HITS:
        raise ValueError(f"{starts} starts cannot agree {FEW_HITS} times")
    size = min(PASS, -(-len(fleet) // threads)) if fleet else 1
    parts = [fleet[k : k + size] for k in range(0, len(fleet), size)] or [fleet]
    done = 0

    def one(part: Sequence[Loops]) -> FleetFit:
        nonlocal done
        found = _fit_part(part, variant, weights, starts, max_waves, seed)
        done += len(part)
        if progress is not None:
            progress(f"{done} of {len(fleet)} dampers")
        return found

    if threads == 1:
        return joined([one(part) for part in parts])
    with ThreadPoolExecutor(threads) as pool:
        return joined(list(pool.map(one, parts)))


def _fit_part(
    fleet: Sequence[Loops],
    variant: Variant,
    weights: Weights,
    starts: int,
    max_waves: int,
    seed: int,
) -> FleetFit:
    stack = stack_loops(fleet, weights)
    first = fleet_starts(fleet, stack, variant)
    screen = thinned(stack, SCREEN_POINTS)
    ends, found = _waves(screen, variant, first, starts, max_waves, seed)
    last, more = to_the_bottom(stack, variant, ends)
    parameters, rmse = _read(variant, stack, last.u)
    tests = [slice(len(loops.ids)) for loops in fleet]
    rmse = tuple(row[used] for row, used in zip(rmse, tests, strict=True))
    return FleetFit(
        variant=variant,
        weights=weights,
        parameters=parameters,
        u=last.u,
        reference=jax.tree.map(np.asarray, stack.reference),
        cost=last.cost * np.asarray(stack.scale),
        rmse=rmse,
        nrmse=tuple(r / np.abs(z.force).max(axis=1) for r, z in zip(rmse, fleet, strict=True)),
        results=tuple(
            _result(hits, end) for hits, end in zip(found.hits, last.converged, strict=True)
        ),
        starts=found.starts,
        basins=tuple(map(basins, ends.cost, ends.converged)),
        steps=ends.steps.sum(axis=1) + more,
    )


def _result(hits: np.int64, converged: np.bool_) -> Result:
    if not converged:
        return Result.unfinished
    return Result.rare if hits < FEW_HITS else Result.converged


def _waves(
    screen: Stack,
    variant: Variant,
    first: Float[np.ndarray, "damper n"],
    starts: int,
    max_waves: int,
    seed: int,
) -> tuple[Ends, Evidence]:
    """Ends of all starts, [D, S], NaN where a damper had none, and what they tell."""
    dampers, n = first.shape
    rng = np.random.default_rng(seed)
    waves: list[Ends] = []
    left = np.arange(dampers)
    while True:
        count = starts if not waves else WAVE
        scatter = SPREADS[len(waves) % len(SPREADS)] * rng.standard_normal((count, n))
        if not waves:
            scatter[0] = 0.0
        begin = first[left, None] + scatter
        flat = walk_all(
            variant, screen, np.repeat(left, count), begin.reshape(-1, n),
            tolerance=COARSE, max_steps=COARSE_STEPS, damping=COARSE_DAMPING,
        )  # fmt: skip
        waves.append(_spread(flat, left, dampers, count))
        ends = Ends(*(
            np.concatenate([getattr(wave, field.name) for wave in waves], axis=1)
            for field in fields(Ends)
        ))  # fmt: skip
        found = evidence(ends.cost, ends.converged)
        left = np.flatnonzero(~found.enough)
        if not left.size or len(waves) >= max_waves:
            return ends, found


def _spread(flat: Ends, left: np.ndarray, dampers: int, count: int) -> Ends:
    """Ends of a wave as [D, S]; NaN for dampers that were not in it."""

    def rows(z: np.ndarray, missing: float) -> np.ndarray:
        full = np.full((dampers, count, *z.shape[1:]), missing, dtype=np.asarray(missing).dtype)
        full[left] = z.reshape(len(left), count, *z.shape[1:])
        return full

    return Ends(
        u=rows(flat.u, 0.0),
        cost=rows(np.where(np.isnan(flat.cost), np.inf, flat.cost), np.nan),
        steps=rows(flat.steps, 0),
        converged=rows(flat.converged, False),
        slope=rows(flat.slope, 0.0),
        gradient=rows(flat.gradient, 0.0),
    )


def _read(
    variant: Variant, stack: Stack, u: Float[np.ndarray, "damper n"]
) -> tuple[np.ndarray, np.ndarray]:
    """`_parameters` of any number of dampers, by a program for one number of them."""
    size, found = SLOTS[0], []
    for k in range(0, len(u), size):
        index = np.minimum(np.arange(k, k + size), len(u) - 1)
        found.append(_parameters(variant, stack.rows(index), u[index]))
    return tuple(np.concatenate(z)[: len(u)] for z in zip(*found, strict=True))  # type: ignore[return-value]


@eqx.filter_jit
def _parameters(
    variant: Variant, stack: Stack, u: Float[Array | np.ndarray, "damper n"]
) -> tuple[Float[Array, "damper 16"], Float[Array, "damper test"]]:
    """Parameters in SI units, and the RMS error of every test, N."""

    def one(u: Array, reference: Reference, *test: Array) -> tuple[Array, Array]:
        valve = GeneralizedCoordinates(reference, variant).valve(u)
        return values(valve), loop_numbers(valve, *test)

    weight = jnp.asarray(stack.weight)
    tests = (jnp.asarray(stack.peak_velocity), jnp.asarray(stack.current), weight)
    parameters, q = jax.vmap(one)(jnp.asarray(u), stack.reference, *tests)
    residual = loop_columns(q, jnp.asarray(stack.velocity), stack.force, stack.sign)[..., -1, :]
    rms = jnp.sqrt(jnp.mean(residual**2, axis=-1))
    return parameters, rms / jnp.where(weight > 0.0, weight, 1.0)
