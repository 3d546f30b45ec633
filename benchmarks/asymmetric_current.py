"""W11's asymmetric current on a symmetric damper: force ratios, a fit, what that gets wrong.

``python benchmarks/asymmetric_current.py`` writes results/asymmetric_current.{md,json};
``--quick`` leaves the diagnosis out and writes nothing.
"""

import contextlib
import io
import json
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from outcome import Outcome

from sysid.cards.models import damper_of
from sysid.cards.read import read_card
from sysid.cli.app import run
from sysid.effects.drive.coil_lag import CoilLag
from sysid.effects.registry import make
from sysid.isolator.asymmetric_current import Asymmetry, asymmetric_sines, ratios, ratios_of
from sysid.models.damper import Damper
from sysid.models.generalized import ASYMMETRIC, LOW_SYMMETRIC, Generalized
from sysid.models.simulate import simulate
from sysid.motion.motion import Motion, sine_motion
from sysid.parameters import build

AMPLITUDES, FREQUENCIES, CURRENTS = (0.0125, 0.025), (0.5, 1.5), (0.0, 0.1, 0.2, 0.3)
SYMMETRIC = Damper(build(Generalized, LOW_SYMMETRIC), (make(CoilLag, 0.003),))
"""W11's low set, with BS09's lag of 3 ms."""
PUBLISHED = Damper(build(Generalized, ASYMMETRIC))
LAGS, SHARPNESS, RISING = (0.003, 0.010, 0.025), (2.0, 10.0, 1e9), (0.5, 1.5, 2.5, 5.0)
"""s of the coil, ζ, Hz."""
POINTS = 720
DATASET = Path(__file__).resolve().parent.parent / "datasets" / "virtual-asymmetric"
"""Raw tests of the symmetric damper behind that current, p = 0 and ζ = 2, by `sysid rig`."""


ASKED = (
    ("on the same 16 parameters", ("--model", "generalized")),
    ("on the base models that it tries by itself", ()),
)
"""A diagnosis in words, and what it is asked with."""


def tests() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """W11's asymmetric tests: m, Hz, A."""
    grid = np.meshgrid(AMPLITUDES, FREQUENCIES, CURRENTS, indexing="ij")
    a, f, i = (z.ravel() for z in grid)
    return a, f, i


def asymmetric_force(motion: Motion, zeta: float) -> np.ndarray:
    """Of the symmetric damper when the current follows the direction."""
    return np.asarray(simulate(SYMMETRIC, Asymmetry(0.0, zeta).driven(motion)))


def at_standstill(motion: Motion, force: np.ndarray) -> np.ndarray:
    """Mean force of both reversals, N: the two sides of a symmetric loop cancel, [loop]."""
    quarter = force.shape[-1] // 4
    return 0.5 * (force[:, quarter] + force[:, 3 * quarter])


def asked(*words: str) -> dict[str, Any]:
    """What a command prints with --json."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        code = run([*words, "--json", "--quiet"])
    assert code in (0, 3), code
    return json.loads(out.getvalue())


def force_ratios(outcome: Outcome) -> None:
    a, f, i = tests()
    motion = sine_motion(a, f, i, points=POINTS)
    speed = 2.0 * np.pi * a * f
    columns = {
        "ζ = 2": asymmetric_force(motion, 2.0),
        "ζ = 10": asymmetric_force(motion, 10.0),
        "ζ → ∞": asymmetric_force(motion, 1e9),
        "published 16 parameters": np.asarray(simulate(PUBLISHED, motion)),
    }
    velocity = np.asarray(motion.velocity)
    gamma = {name: ratios(force, velocity, speed, i).at_peak for name, force in columns.items()}
    outcome.say(
        "Force in rebound over compression, each at the largest speed (γ), for p = 0: W11's",
        "symmetric model (low set) behind the modulated current and 3 ms of lag, and the published",
        "asymmetric model.",
    )
    rows = [
        (f"{speed[k]:.3f}", f"{i[k]:g}", *(f"{gamma[name][k]:.2f}" for name in gamma))
        for k in np.lexsort((i, speed))
    ]
    outcome.table(("v_m, m/s", "i, A", *gamma), rows)
    outcome.numbers["gamma"] = {name: z.tolist() for name, z in gamma.items()}
    outcome.say(
        "The text's “order of 4” at low speed is what no current in compression makes (ζ → ∞):",
        "the ratio of the force gains, C(0.3 A)/C(0 A), at every speed.  Eq. 2 with its ζ = 2",
        "ends at 0.15 and 0.85 of the current and gives about 2.  A symmetric damper whose gain",
        "multiplies all of its force has a γ that does not know speed; the published asymmetric",
        "model gets its fall from an offset.  A slow coil makes γ fall as well, 12.5 mm, 0.3 A:",
    )
    lagging = []
    for zeta in SHARPNESS:
        driven = asymmetric_sines(Asymmetry(0.0, zeta), 0.0125, list(RISING), [0.3])
        for lag in LAGS:
            slow = Damper(SYMMETRIC.valve, (make(CoilLag, lag),))
            lagging.append((zeta, lag, ratios_of(slow, driven).at_peak.tolist()))
    outcome.table(
        ("ζ", "lag of the coil", *(f"{z:g} Hz" for z in RISING)),
        [
            (f"{zeta:g}" if zeta < 1e6 else "∞", f"{1e3 * lag:g} ms", *(f"{z:.2f}" for z in found))
            for zeta, lag, found in lagging
        ],
    )
    outcome.numbers["lag"] = [{"zeta": z, "lag_s": t, "gamma": g} for z, t, g in lagging]
    idle = i == 0.0
    standstill = {name: at_standstill(motion, force)[idle] for name, force in columns.items()}
    outcome.numbers["standstill_N"] = {name: z.tolist() for name, z in standstill.items()}
    low, high = (
        float(getattr(standstill["published 16 parameters"], side)()) for side in ("min", "max")
    )
    outcome.say(
        "At 0 A a modulated current is no current, and the damper is symmetric: the mean force of",
        f"both reversals is {float(np.abs(standstill['ζ = 2']).max()):.1f} N.  The published",
        f"asymmetric model has {low:.0f} to {high:.0f} N there.",
    )


def fitted(outcome: Outcome, quick: bool) -> None:
    a, f, i = tests()
    idle = i == 0.0
    motion = sine_motion(a, f, i, points=POINTS)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        summary = asked("fit", str(DATASET), "-o", str(folder / "fit"), "--no-posterior")
        card = read_card(folder / "fit" / "card.json")
        told = [] if quick else [diagnosis(folder / name, *words) for name, words in ASKED]
    force = np.asarray(simulate(damper_of(card), motion))
    offset = at_standstill(motion, force)[idle]
    errors = {test["id"]: test["nrmse"] for test in summary["tests"]}
    zero = float(np.mean([z for id, z in errors.items() if id.endswith("_0A")]))
    rest = float(np.mean([z for id, z in errors.items() if not id.endswith("_0A")]))
    outcome.numbers["fit"] = {
        "mean_nrmse": summary["summary"]["mean_nrmse"], "at_0A": zero, "with_current": rest,
        "standstill_N": offset.tolist(),
    }  # fmt: skip
    outcome.say(
        "The 16 parameters fitted to `datasets/virtual-asymmetric` (p = 0, ζ = 2, the recorded",
        f"current is the commanded one): mean error {summary['summary']['mean_nrmse']:.1%} of",
        f"max|F|, {zero:.1%} at 0 A and {rest:.1%} with current.  Mean force of both reversals",
        f"at 0 A: {offset.min():.0f} to {offset.max():.0f} N, where the damper has none: the",
        "defect of the published set is the model's own, in which the asymmetry (k_5, k_6,",
        "k_1c ≠ k_1e) does not",
        "go with the current.",
    )
    for (base, _), lines in zip(ASKED, told, strict=False):
        outcome.say(f"What `sysid diagnose` says of these tests, {base}:")
        outcome.lines += ["", *(f"> {line}" for line in lines)]
        outcome.numbers[f"diagnosis, {base}"] = lines


def diagnosis(folder: Path, *words: str) -> list[str]:
    """The answer's first lines."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        run(["diagnose", str(DATASET), "-o", str(folder), "--quiet", *words])
    lines = out.getvalue().splitlines()
    end = next((k for k, line in enumerate(lines) if not line.strip()), 6)
    return [line.strip() for line in lines[:end]]


def main() -> None:
    quick = "--quick" in sys.argv
    outcome = Outcome(
        "asymmetric_current", "Asymmetric current on a symmetric damper (W11 Eqs. 1–2)"
    )
    force_ratios(outcome)
    fitted(outcome, quick)
    outcome.finish(keep=not quick)


if __name__ == "__main__":
    main()
