"""Sparse regression of what the base leaves on a library of functions, as a rival to a diagnosis.

What PySINDy-style discrepancy models do: sequentially thresholded least squares (Brunton, Proctor
and Kutz, PNAS 113 (2016)) on the residual of the fitted base; the threshold by cross-validation
over (amplitude, frequency) conditions, the sparsest model within one standard error of the best.
Each column stands for the effect of the catalogue that it is nearest to; the largest terms are
the names given.
"""

from collections.abc import Callable
from typing import Final

import numpy as np

from sysid.data.loops import Loops
from sysid.identification.conditions import conditions
from sysid.identification.result import Fit
from sysid.models.simulate import simulate
from sysid.motion.motion import loop_motion
from sysid.trials.score import Given, family_of

Column = Callable[[dict[str, np.ndarray]], np.ndarray]

LIBRARY: Final[tuple[tuple[str, str | None, Column], ...]] = (
    ("1", "force_offset", lambda z: np.ones_like(z["x"])),
    ("x", "gas_spring", lambda z: z["x"]),
    ("x²", "gas_polytropic", lambda z: z["x"] ** 2),
    ("x³", "bump_stop", lambda z: z["x"] ** 3),
    ("v", "linear_viscosity", lambda z: z["v"]),
    ("v²", None, lambda z: z["v"] ** 2),
    ("v|v|", "quadratic_loss", lambda z: z["v"] * np.abs(z["v"])),
    ("|v|^0.7 sgn v", "shear_thinning", lambda z: np.abs(z["v"]) ** 0.7 * np.sign(z["v"])),
    ("a", "fluid_inertia", lambda z: z["a"]),
    ("sgn v", "seal_friction", lambda z: np.sign(z["v"])),
    ("x sgn v", "position_friction", lambda z: z["x"] * np.sign(z["v"])),
    ("|x| sgn v", None, lambda z: np.abs(z["x"]) * np.sign(z["v"])),
    ("x v", None, lambda z: z["x"] * z["v"]),
    ("i sgn v", None, lambda z: z["i"] * np.sign(z["v"])),
    ("i x", None, lambda z: z["i"] * z["x"]),
    ("i v", "eddy_loss", lambda z: z["i"] * z["v"]),
    ("i a", "series_compliance", lambda z: z["i"] * z["a"]),
    ("f v", None, lambda z: np.log(z["f"]) * z["v"]),
    ("F log f", "frequency_law", lambda z: np.log(z["f"]) * z["F"]),
    ("F sgn v", "asymmetric_gain", lambda z: z["F"] * np.sign(z["v"])),
    ("dF/dt", "force_delay", lambda z: z["dF"]),
    ("T", "gas_temperature", lambda z: z["T"] * np.ones_like(z["x"])),
    ("T v", "viscosity_temperature", lambda z: z["T"] * z["v"]),
    ("T i sgn v", "yield_temperature", lambda z: z["T"] * z["i"] * np.sign(z["v"])),
)
"""Name, id of the effect that it stands for, values."""

THRESHOLDS: Final = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 0.8, np.inf)
"""Of a standardised coefficient, parts of the residual's RMS; the last one leaves nothing."""
FOLDS: Final = 6
LARGE: Final = 0.5
"""Names are terms at least this large beside the largest."""


def sparse_names(base: Fit, loops: Loops) -> tuple[Given, ...]:
    """Names that sparse regression gives for what a fitted base leaves."""
    simulated = np.asarray(simulate(base.valve, loop_motion(loops)))
    residual = loops.force - simulated
    columns = np.concatenate([standardised(loops, simulated), residual[:, :, None]], axis=2)
    condition = conditions(loops)
    fold = np.random.default_rng(0).permutation(condition.max() + 1)[condition] % FOLDS
    flat = [columns[fold == k].reshape(-1, columns.shape[2]) for k in range(FOLDS)]
    grams = np.stack([z.T @ z for z in flat])
    scale = float(np.sqrt(np.mean(residual**2)))
    threshold = choose_threshold(grams, scale)
    size = np.abs(threshold_least_squares(grams.sum(axis=0), threshold * scale))
    if not size.any():
        return ()
    order = [k for k in np.argsort(-size) if size[k] >= LARGE * size.max()]
    ids = dict.fromkeys(LIBRARY[k][1] for k in order)
    return tuple(
        Given("named", (name,), family_of(name) or "", float("nan"), False)
        for name in ids
        if name is not None
    )


def standardised(loops: Loops, force: np.ndarray) -> np.ndarray:
    """The library on all points, [L, J, columns], each column with RMS 1."""
    points = force.shape[1]
    order = np.fft.rfftfreq(points, 1.0 / points)
    rate = np.fft.irfft(2j * np.pi * order * np.fft.rfft(force, axis=1), points, axis=1)
    z = {
        "x": loops.displacement, "v": loops.velocity, "a": loops.acceleration, "F": force,
        "dF": rate * loops.frequency[:, None], "i": loops.current[:, None],
        "f": loops.frequency[:, None], "T": np.nan_to_num(loops.temperature[:, None] - 40.0),
    }  # fmt: skip
    every = np.stack([np.broadcast_to(make(z), force.shape) for _, _, make in LIBRARY], axis=2)
    return every / np.maximum(np.sqrt(np.mean(every**2, axis=(0, 1))), 1e-300)


def threshold_least_squares(gram: np.ndarray, threshold: float) -> np.ndarray:
    """Least squares, small coefficients to zero, again on the rest, until nothing changes.

    Args:
        gram: [k + 1, k + 1], [columns, target]ᵀ[columns, target].
        threshold: Smallest coefficient that stays.

    Returns:
        [k] coefficients.
    """
    size = gram.shape[0] - 1
    kept = np.full(size, np.isfinite(threshold))
    found = np.zeros(size)
    while kept.any():
        found = np.zeros(size)
        rows = np.flatnonzero(kept)
        found[rows] = np.linalg.lstsq(gram[np.ix_(rows, rows)], gram[rows, -1], rcond=1e-12)[0]
        large = np.abs(found) >= threshold
        if (large == kept).all():
            return found
        kept = large & kept
    return np.zeros_like(found)


def choose_threshold(grams: np.ndarray, scale: float) -> float:
    """The largest threshold whose held-out error is within one standard error of the best.

    Args:
        grams: [folds, k + 1, k + 1].
        scale: RMS of the residual, N.
    """
    errors = np.zeros((len(THRESHOLDS), len(grams)))
    for k, test in enumerate(grams):
        for t, threshold in enumerate(THRESHOLDS):
            found = threshold_least_squares(grams.sum(axis=0) - test, threshold * scale)
            left = np.append(-found, 1.0)
            errors[t, k] = left @ test @ left
    mean = errors.mean(axis=1)
    best = int(np.argmin(mean))
    allowed = mean[best] + errors[best].std(ddof=1) / np.sqrt(len(grams))
    return THRESHOLDS[max(t for t in range(len(THRESHOLDS)) if mean[t] <= allowed)]
