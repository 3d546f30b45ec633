"""Diagnoses made by hand: a damper of W11's low set with play in the rod, and answers about it."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from sysid.data.loops import Loops
from sysid.diagnosis.result import (
    Anova,
    Cause,
    Dependence,
    Diagnosis,
    Gain,
    Invisible,
    Joint,
    Quantity,
    Rival,
    ScreenRow,
    Term,
    Unknown,
)
from sysid.effects.base import AbstractEffect
from sysid.effects.registry import EFFECTS, make
from sysid.identification.families import family
from sysid.identification.problem import loop_problem
from sysid.identification.result import Fit, Result
from sysid.models.damper import Damper
from sysid.models.generalized import LOW_SYMMETRIC, Generalized
from sysid.models.simulate import simulate
from sysid.motion.motion import loop_motion
from sysid.parameters import as_dict, build, specs

CONDITIONS = tuple(
    (a, f, i)
    for a, frequencies in ((2.5e-3, (2.5, 5.0)), (12.5e-3, (0.5, 2.5)), (25e-3, (0.5, 2.5)))
    for f in frequencies
    for i in (0.0, 0.2, 0.4)
)  # fmt: skip
"""Amplitude m, frequency Hz, current A."""

VALVE = build(Generalized, LOW_SYMMETRIC)
PLAY = make({k.facts.id: k for k in EFFECTS}["backlash"], 4.1e-4)


def made_loops(points: int = 360) -> Loops:
    """Loops with the right motion; their force is zero still."""
    a, f, i = np.array(CONDITIONS).T
    phase = 2 * np.pi * np.arange(points) / points
    omega = 2 * np.pi * f[:, None]
    x = a[:, None] * np.sin(phase)
    count = a.size
    harmonics = np.zeros((count, 15), dtype=complex)
    harmonics[:, 0] = a
    return Loops(
        ids=tuple(f"{1e3 * a:g}mm_{f:g}Hz_{i:g}A" for a, f, i in CONDITIONS),
        displacement=x,
        velocity=omega * a[:, None] * np.cos(phase),
        acceleration=-(omega**2) * x,
        force=np.zeros((count, points)),
        amplitude=a,
        frequency=f,
        current=i,
        temperature=np.full(count, 40.0),
        centre=np.zeros(count),
        cycles=np.full(count, 4),
        noise_floor=np.full(count, 4.0),
        deviations=tuple(np.zeros((4, points)) for _ in range(count)),
        displacement_deviations=tuple(np.zeros((4, points)) for _ in range(count)),
        harmonics=harmonics,
    )


def nrmse(loops: Loops, simulated: np.ndarray) -> np.ndarray:
    rmse = np.sqrt(np.mean((simulated - loops.force) ** 2, axis=1))
    return rmse / np.abs(loops.force).max(axis=1)


def made_fit(loops: Loops) -> Fit:
    """A fit as it would be found; nothing was fitted."""
    problem = loop_problem(loops)
    coordinates = family("generalized").coordinates(problem.reference, "symmetric")
    return Fit(
        model="generalized", variant="symmetric", weights="paper", valve=VALVE,
        coordinates=coordinates, u=np.zeros(coordinates.size), problems=(problem,),
        condition=np.arange(len(loops.ids)), cost=1.0, result=Result.converged, starts=4,
        basins=(), tests=(),
    )  # fmt: skip


def quantity(effect: AbstractEffect, symbol: str, value: float, half: float) -> Quantity:
    spec = next(s for s in specs(effect) if s.symbol == symbol)
    return Quantity(symbol, spec.name, value, spec.unit, half / 1.96, value - half, value + half)


@cache
def backlash() -> Diagnosis:
    """Play of 0.41 mm, named."""
    bare = made_loops()
    force = np.asarray(simulate(Damper(VALVE, (PLAY,)), loop_motion(bare)))
    noise = np.random.default_rng(1).normal(0.0, 2.0, force.shape)
    return named_backlash(replace(bare, force=force + noise))


def named_backlash(loops: Loops) -> Diagnosis:
    """The answer "play of 0.41 mm", whatever the loops say."""
    motion = loop_motion(loops)
    damper = Damper(VALVE, (PLAY,))
    before = np.asarray(simulate(Damper(VALVE), motion))
    after = np.asarray(simulate(damper, motion))
    e_before, e_after = nrmse(loops, before), nrmse(loops, after)
    floor = loops.noise_floor / 2.0 / np.abs(loops.force).max(axis=1)
    cause = Cause(
        status="named", id="backlash", members=("backlash",), family="lost_motion", effect=PLAY,
        parameters=(quantity(PLAY, "delta", 4.1e-4, 2e-5),), confidence=0.97, score=812.0,
        share=0.95, extra_error=44.0, because="a score of 812 against a threshold of 14",
        separating_test=None, stability=0.98,
    )  # fmt: skip
    gain = Gain(
        before=float(e_before.mean()), after=float(e_after.mean()), floor=float(floor.mean()),
        repeatability=float(2 * floor.mean()), reducible_explained=0.95, low=0.93, high=0.97,
        per_test_before=e_before, per_test_after=e_after, held_out=loops.ids,
        extrapolation=(("the largest amplitude", 0.12, 0.031),),
    )  # fmt: skip
    base = Rival("generalized", "symmetric", gain.before, gain.after, True)
    symbols = (*as_dict(VALVE), "backlash.delta")
    return Diagnosis(
        answer="named",
        causes=(cause,),
        invisible=(
            Invisible("load_cell_gain", "the base absorbs it", "a dead weight"),
            Invisible("coil_lag", "the current is constant", "steps of the current"),
        ),
        unknown=Unknown(False, 0.02, {"OD": 0.4, "OC": 0.3, "ED": 0.2, "EC": 0.1}, {}, ()),
        gain=gain,
        screen=made_screen(),
        base=base,
        rivals=(base, Rival("bouc_wen", "full", 0.14, float("nan"), False)),
        fit=made_fit(loops),
        base_damper=Damper(VALVE),
        damper=damper,
        symbols=symbols,
        values=np.array([*as_dict(VALVE).values(), 4.1e-4]),
        covariance=np.eye(len(symbols)) * 1e-12,
        interval="made by hand",
        loops=loops,
        simulated_before=before,
        simulated_after=after,
        notes=("priors were used for gain, offset and delay",),
    )


def made_screen() -> tuple[ScreenRow, ...]:
    loops = [k.facts for k in EFFECTS if k.facts.found_from == "loops"]
    scores = np.geomspace(812.0, 0.05, len(loops) - 3)
    order = sorted(loops, key=lambda f: f.id != "backlash")
    rows = [
        ScreenRow(f.id, float(s), 13.6, 0.4, 1.1 * f.nominal[f.size], 0.1 * abs(f.nominal[f.size]))
        for f, s in zip(order, scores, strict=False)
    ]
    nan = float("nan")
    return (*rows, *(ScreenRow(f.id, 0.0, 13.6, 1e-4, nan, nan) for f in order[len(rows) :]))


def made(**changes: Any) -> Diagnosis:
    """The same with some fields changed."""
    return replace(backlash(), **changes)


def nothing() -> Diagnosis:
    d = backlash()
    loops = replace(d.loops, force=d.simulated_before + (d.loops.force - d.simulated_after))
    base = Rival("generalized", "symmetric", 0.012, float("nan"), True)
    return replace(
        d, answer="nothing", causes=(), gain=None, damper=d.base_damper, loops=loops, base=base,
        rivals=(base,), simulated_after=d.simulated_before,
    )  # fmt: skip


def unknown() -> Diagnosis:
    d = backlash()
    rest = Unknown(
        present=True, share_of_reducible=0.83,
        parity={"OD": 0.2, "OC": 0.61, "ED": 0.1, "EC": 0.09},
        exponents={"amplitude": 0.98, "frequency": float("nan"), "current": 0.04},
        depends_on=("amplitude", "current"), moves="k_1e",
        because=("a spring that stiffens with travel would look like this",),
        anova=Anova(
            explained=0.71, constant=0.0,
            quantities=(
                Dependence("position", 0.4, 0.6, 0.05), Dependence("acceleration", 0.3, 0.5, 0.02),
                Dependence("current", 0.01, 0.0, 0.0),
            ),
            pairs=(Joint("position", "acceleration", 0.08),),
        ),
        proposal=(
            Term("x|x|", "OC", 18560.0, "N/m^2", 110.0, 0.4, 0.03, 1.0),
            Term("1", "EC", -12.34, "N", 0.56, 0.06, 0.01, 0.9),
        ),
        strange=97.0,
    )  # fmt: skip
    return replace(
        d, answer="unknown", causes=(), gain=None, damper=d.base_damper, unknown=rest,
        simulated_after=d.simulated_before,
    )  # fmt: skip


def inadequate() -> Diagnosis:
    base = Rival("generalized", "symmetric", 0.29, 0.21, False)
    other = Rival("dahl", "full", 0.33, float("nan"), False)
    d = unknown()
    return replace(
        d, answer="base_inadequate", base=base, rivals=(base, other),
        unknown=replace(d.unknown, present=False),
    )  # fmt: skip
