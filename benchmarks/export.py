"""Exported cards: agreement with the Python simulation, speed, and what estimating costs.

``python benchmarks/export.py`` writes results/export.{md,json}; ``--quick`` computes a tenth of the
steps and writes nothing.  It needs a C compiler, and FMPy for the FMU.
"""

import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from outcome import Outcome

from sysid.cards.check import check_vectors
from sysid.cards.export.c_program import c_program
from sysid.cards.export.fmu import fmu_of
from sysid.cards.export.pieces import pieces_of
from sysid.cards.models import MODELS
from sysid.cards.read import read_card
from sysid.cards.schema import Card
from sysid.effects.base import AbstractEffect
from sysid.effects.registry import choices, effect_kind
from sysid.models.damper import Damper
from sysid.models.lumped import TABLE_1, Lumped
from sysid.models.simulate import simulate
from sysid.motion.time_motion import time_motion
from sysid.parameters import build

FITS = Path(__file__).parents[1] / "fits"
RATE = 5000.0
"""Hz."""


@dataclass(frozen=True)
class Case:
    """An exported damper."""

    name: str
    model: str
    damper: Damper


def effect(id: str, **changed: object) -> AbstractEffect:
    kind = effect_kind(id)
    return kind(**{**kind.facts.nominal, **choices(kind)[0], **changed})


def cases(card: Card) -> tuple[Case, ...]:
    """W11's model as fitted, the same with what makes it costly, and BS09's model."""
    values = card.values()
    generalized = build(MODELS["generalized"], values)
    found = (
        effect("series_compliance", s_k=1e-7), effect("bypass_leakage"),
        effect("presliding_friction"), effect("gas_spring"),
    )  # fmt: skip
    dahl = {
        "c_a": 800.0, "c_b": 900.0, "k_0": 1500.0, "f_0": 40.0, "alpha_a": 100.0,
        "alpha_b": 2500.0, "rho": 3000.0, "q": 1.3,
    }  # fmt: skip
    return (
        Case("W11, 16 parameters", "generalized", Damper(generalized)),
        Case("the same, spring, leak, presliding, gas", "generalized", Damper(generalized, found)),
        Case("Dahl, eddy loss, play", "dahl",
             Damper(build(MODELS["dahl"], dahl), (effect("eddy_loss"), effect("backlash")))),
        Case("BS09, lumped", "lumped", Damper(build(Lumped, TABLE_1))),
    )  # fmt: skip


def random_motion(steps: int, peak: float, seed: int = 1) -> np.ndarray:
    """Sines of random phases from 0.3 to 12 Hz, [steps, 6] as an exported program reads them."""
    rng = np.random.default_rng(seed)
    t = np.arange(steps) / RATE
    x, v = np.zeros(steps), np.zeros(steps)
    for f in np.geomspace(0.3, 12.0, 9):
        phase = rng.uniform(0.0, 2.0 * np.pi)
        x += np.sin(2 * np.pi * f * t + phase) / f
        v += 2 * np.pi * np.cos(2 * np.pi * f * t + phase)
    scale = peak / np.abs(v).max()
    current = 0.15 + 0.14 * np.sin(2 * np.pi * 1.7 * t)
    warm = 40.0 + 10.0 * np.sin(2 * np.pi * 0.01 * t)
    return np.stack([t, scale * x, scale * v, np.full(steps, np.nan), current, warm], axis=1)


def python_force(damper: Damper, rows: np.ndarray) -> np.ndarray:
    """`sysid simulate --causal`."""
    t, x, v, _, i, warm = rows.T
    motion = time_motion(t, x, velocity=v, current=i, temperature=warm, causal=True)
    return np.asarray(simulate(damper, motion))


def built(card: Card, case: Case, folder: Path) -> Path:
    """The test program of a case."""
    texts = c_program(card, pieces_of(case.damper, case.model), "unit")
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    command = ["cc", "-std=c99", "-O2", "-o", "unit", "unit.c", "unit_test.c", "-lm"]
    subprocess.run(command, cwd=folder, check=True)
    return folder / "unit"


def c_force(program: Path, rows: np.ndarray) -> np.ndarray:
    file = program.parent / "motion.csv"
    np.savetxt(file, rows, delimiter=",", fmt="%.17g")
    done = subprocess.run([program, file], capture_output=True, text=True, check=True)
    return np.array([line.split(",")[0] for line in done.stdout.split()], dtype=float)


def fmu_force(card: Card, case: Case, rows: np.ndarray, folder: Path) -> np.ndarray:
    """By FMPy, step by step."""
    import fmpy
    from fmpy.fmi2 import FMU2Slave
    from fmpy.validation import validate_fmu

    path = folder / "unit.fmu"
    path.write_bytes(fmu_of(card, pieces_of(case.damper, case.model), "unit").data)
    problems = validate_fmu(str(path))
    assert not problems, problems
    told = fmpy.read_model_description(str(path))
    slave = FMU2Slave(
        guid=told.guid, unzipDirectory=fmpy.extract(str(path), str(folder / "fmu")),
        modelIdentifier="unit", instanceName="one",
    )  # fmt: skip
    slave.instantiate()
    slave.setupExperiment(startTime=rows[0, 0])
    slave.enterInitializationMode()
    force = np.zeros(len(rows))
    for k, (t, x, v, _, i, warm) in enumerate(rows.tolist()):
        slave.setReal([0, 1, 3, 4], [x, v, i, warm])
        if k == 0:
            slave.exitInitializationMode()
        else:
            slave.doStep(rows[k - 1, 0], t - rows[k - 1, 0])
        force[k] = slave.getReal([5])[0]
    slave.terminate()
    slave.freeInstance()
    return force


def apart(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.abs(found - expected).max() / np.abs(expected).max())


def timed(program: Path, steps: int) -> tuple[float, float, float]:
    """Times real time, µs a step, µs of the longest step."""
    done = subprocess.run(
        [program, "--time", str(steps)], capture_output=True, text=True, check=True
    )
    words = done.stdout.replace(",", "").split()
    return (
        float(words[words.index("times") - 1]),
        float(words[words.index("us") - 1]),
        float(words[words.index("longest") + 1]),
    )


def estimated(card: Card, outcome: Outcome) -> None:
    """What noise in the displacement costs where velocity or acceleration are estimated."""
    damper = Damper(build(MODELS["generalized"], card.values()))
    rows = random_motion(int(5 * RATE), 0.2)
    t, x, v, _, i, warm = rows.T
    a = np.gradient(v, t)
    shared = {"current": i, "temperature": warm}
    exact = np.asarray(simulate(damper, time_motion(t, x, velocity=v, acceleration=a, **shared)))
    largest, found = np.abs(exact).max(), []
    for noise in (0.0, 1e-7, 1e-6, 1e-5):
        rng = np.random.default_rng(5)
        seen = x + noise * rng.standard_normal(t.size)
        speed = v + 100.0 * noise * rng.standard_normal(t.size)
        given = {
            "acceleration estimated from a velocity": time_motion(
                t, seen, velocity=speed, causal=True, **shared
            ),
            "both estimated from the displacement": time_motion(t, seen, causal=True, **shared),
        }
        errors = [
            float(np.sqrt(np.mean((np.asarray(simulate(damper, m)) - exact) ** 2)) / largest)
            for m in given.values()
        ]
        found.append({"noise_m": noise, "rms_share": errors})
    outcome.numbers["estimated"] = found
    outcome.say(
        "Acceleration is estimated from the newest three velocities, and velocity from the newest",
        "three displacements where that is not given either.  RMS error of W11's force on the",
        f"random motion ({RATE:g} Hz, 0.2 m/s peak), parts of the largest force, with noise of",
        "that standard deviation in the displacement, and of 100/s times that in a velocity:",
    )
    outcome.table(
        ("noise of displacement", "velocity given", "displacement alone"),
        [
            (f"{1e6 * row['noise_m']:g} µm", *(f"{share:.2%}" for share in row["rms_share"]))
            for row in found
        ],
    )


def main() -> None:
    quick = "--quick" in sys.argv
    steps = 100_000 if quick else 1_000_000
    card = read_card(FITS / "virtual-w11-asymmetric" / "card.json")
    outcome = Outcome("export", "Exported cards against the Python simulation")
    outcome.say(
        "Largest difference from `sysid simulate --causal`, parts of the largest force: on random",
        f"motion of 5 s at {RATE:g} Hz by the C program and by the FMU in FMPy, and on {steps:,}",
        "steps by the C program (all steps / the last tenth).",
    )
    rows, numbers = [], []
    for case in cases(card):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            own = card.model_copy(update={"check": check_vectors(case.damper, card.validity)})
            program = built(own, case, folder)
            check = subprocess.run([program], capture_output=True, text=True, check=True).stdout
            vectors = max(
                float(line.split("error ")[1].split()[0])
                for line in check.splitlines()
                if "error" in line
            )
            short = random_motion(int(5 * RATE), 0.2)
            expected = python_force(case.damper, short)
            by_c = apart(c_force(program, short), expected)
            by_fmu = apart(fmu_force(own, case, short, folder), expected)
            long = random_motion(steps, 0.2)
            expected, found = python_force(case.damper, long), c_force(program, long)
            last = slice(-steps // 10, None)
            drift = apart(found, expected), apart(found[last], expected[last])
            times, step, longest = timed(program, steps)
        numbers.append(
            {
                "case": case.name, "check_vectors": vectors, "c": by_c, "fmu": by_fmu,
                "long": drift, "times_real_time": times, "us_a_step": step, "longest_us": longest,
            }
        )  # fmt: skip
        print(numbers[-1], file=sys.stderr, flush=True)
        rows.append(
            (
                case.name, f"{vectors:.1e}", f"{by_c:.1e}", f"{by_fmu:.1e}",
                f"{drift[0]:.1e} / {drift[1]:.1e}", f"{times:.0f} ×", f"{step:.2g} µs",
                f"{longest:.2g} µs",
            )
        )  # fmt: skip
    outcome.table(
        (
            "damper", "check vectors", "random, C", "random, FMU", f"{steps:,} steps",
            "speed over real time at 5 kHz", "a step", "longest step",
        ),
        rows,
    )  # fmt: skip
    outcome.say(
        "For speed and longest step each step is taken three times from the same past, and its",
        "shortest time counts, so that what interrupts the program does not.",
    )
    outcome.numbers["cases"] = numbers
    estimated(card, outcome)
    outcome.finish(keep=not quick)


if __name__ == "__main__":
    main()
