"""Fleets that are larger than one machine: chunks of dampers as pieces of work."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from sysid import __version__
from sysid.data.loops import Loops
from sysid.fleet.fit import fit_fleet
from sysid.identification.multistart import WAVE
from sysid.identification.problem import Weights
from sysid.jobs.job import Job
from sysid.models.generalized import Generalized
from sysid.models.generalized_coordinates import Variant
from sysid.parameters import specs

CHUNK: Final = 128
"""Dampers of a chunk: enough to keep a batch full, few enough to lose when a worker dies."""


@dataclass(frozen=True)
class Chunk:
    """Some dampers of a fleet, and how they are fitted.

    Attributes:
        names: Of the dampers.
        fleet: Their loops.
        variant: See `fit_fleet`, as the rest.
        weights: Of the tests.
        starts: Of every damper.
        seed: Of the scatter of starts.
    """

    names: tuple[str, ...]
    fleet: tuple[Loops, ...]
    variant: Variant = "asymmetric"
    weights: Weights = "paper"
    starts: int = WAVE
    seed: int = 0

    @property
    def key(self) -> str:
        """Name of the first damper, and a print of all that the result depends on."""
        asked = (__version__, self.names, self.variant, self.weights, self.starts, self.seed)
        digest = hashlib.sha256(repr(asked).encode())
        for loops in self.fleet:
            for part in (
                loops.displacement, loops.velocity, loops.acceleration, loops.force,
                loops.amplitude, loops.frequency, loops.current, loops.noise_floor,
            ):  # fmt: skip
                digest.update(repr(part.shape).encode())
                digest.update(np.ascontiguousarray(part).tobytes())
        return f"{self.names[0]}-{digest.hexdigest()[:12]}"


def chunk_jobs(
    names: Sequence[str], fleet: Sequence[Loops], *, size: int = CHUNK, **asked: Any
) -> list[Job]:
    """Jobs for `run_jobs` with `fit_chunk`; a row's `key` is its job's.

    Args:
        names: Of D dampers.
        fleet: Their loops.
        size: Dampers of a chunk.
        **asked: Fields of `Chunk`.
    """
    parts = [
        Chunk(tuple(names[k : k + size]), tuple(fleet[k : k + size]), **asked)
        for k in range(0, len(fleet), size)
    ]
    return [Job(part.key, part) for part in parts]


def fit_chunk(chunk: Chunk) -> dict[str, Any]:
    """Fit a chunk wherever we are; a row for all of its dampers."""
    found = fit_fleet(
        chunk.fleet,
        variant=chunk.variant,
        weights=chunk.weights,
        starts=chunk.starts,
        seed=chunk.seed,
    )
    symbols = [spec.symbol for spec in specs(Generalized)]
    dampers = [
        {
            "name": name,
            "result": found.results[k].name,
            "cost": float(found.cost[k]),
            "starts": int(found.starts[k]),
            "mean_nrmse": float(np.mean(found.nrmse[k])),
            "parameters": dict(zip(symbols, found.parameters[k].tolist(), strict=True)),
        }
        for k, name in enumerate(chunk.names)
    ]
    return {"key": chunk.key, "dampers": dampers}
