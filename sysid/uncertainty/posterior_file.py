"""A posterior as one HDF5 file: draws, log-probabilities, and all that is known of them."""

import dataclasses
import io
import json
from pathlib import Path
from typing import Final

import h5py
import numpy as np

from sysid.errors import CardError
from sysid.parameters import ParamSpec
from sysid.uncertainty.compression import CompressionError
from sysid.uncertainty.convergence import Convergence
from sysid.uncertainty.posterior import Posterior

FORMAT: Final = "sysid-posterior-1"
_ARRAYS: Final = ("coordinates", "draws", "log_probability")
_EVIDENCE: Final = ("tau", "rhat", "bulk", "tail")


def thinned(posterior: Posterior) -> Posterior:
    """Every k-th step of a posterior, k half of its shortest autocorrelation time.

    Steps that near to one another say next to nothing new; the evidence stays that of all steps.
    """
    tau = posterior.convergence.tau
    every = max(1, int(0.5 * np.nanmin(tau))) if np.isfinite(tau).any() else 1
    chains, _, n = posterior.draws.shape

    def some(z: np.ndarray, *rest: int) -> np.ndarray:
        steps = z.reshape(chains, -1, posterior.walkers, *rest)[:, every - 1 :: every]
        return steps.reshape(chains, -1, *rest)

    return dataclasses.replace(
        posterior,
        coordinates=some(posterior.coordinates, n),
        draws=some(posterior.draws, n),
        log_probability=some(posterior.log_probability),
    )


def posterior_bytes(posterior: Posterior) -> bytes:
    """Content of the file; the same posterior gives the same bytes."""
    buffer = io.BytesIO()
    with h5py.File(buffer, "w", track_order=True) as file:
        for name in _ARRAYS:
            data = getattr(posterior, name)
            file.create_dataset(name, data=data, compression="gzip", shuffle=True)
        for name in _EVIDENCE:
            file.create_dataset(f"convergence/{name}", data=getattr(posterior.convergence, name))
        file.attrs["format"] = FORMAT
        file.attrs["about"] = json.dumps(_about(posterior), ensure_ascii=False)
    return buffer.getvalue()


def read_posterior(path: Path) -> Posterior:
    """Read what `posterior_bytes` made.

    Raises:
        CardError: It cannot be read, or is another kind of file.
    """
    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != FORMAT:
                raise ValueError("another format")
            arrays = {name: np.asarray(file[name]) for name in _ARRAYS}
            evidence = {name: np.asarray(file[f"convergence/{name}"]) for name in _EVIDENCE}
            about = json.loads(str(file.attrs["about"]))
    except (OSError, KeyError, ValueError) as cause:
        raise CardError(
            f"cannot be read as a posterior of the form {FORMAT}",
            where=path,
            advice="Give a posterior.h5 that `sysid fit` wrote",
        ) from cause
    declared = tuple(ParamSpec(**one) for one in about.pop("declared"))
    return Posterior(
        **arrays,
        declared=declared,
        convergence=Convergence(
            steps=about.pop("steps"), names=tuple(s.symbol for s in declared), **evidence
        ),
        compression=CompressionError(**about.pop("compression")),
        prior=tuple(about.pop("prior")),
        open=tuple(about.pop("open", ())),
        **about,
    )


def _about(posterior: Posterior) -> dict[str, object]:
    names = (
        "model", "variant", "likelihood", "assumed", "prior", "walkers", "acceptance",
        "evaluations", "message", "open",
    )  # fmt: skip
    return {
        **{name: getattr(posterior, name) for name in names},
        "steps": posterior.convergence.steps,
        "declared": [dataclasses.asdict(spec) for spec in posterior.declared],
        "compression": dataclasses.asdict(posterior.compression),
    }
