"""Trial campaigns: loops of a damper with hidden effects, and the truth about them.

A campaign is a random choice of W11's tests, run on a damper near W11's low-range set, with the
errors of a good test rig.
"""

from dataclasses import dataclass, field, fields, replace

import numpy as np
from jaxtyping import Float, Int

from sysid.data.loops import Loops
from sysid.errors import DataError
from sysid.models.generalized import LOW_SYMMETRIC
from sysid.motion.history import RunHistory, run_history
from sysid.rig.bench import Setting
from sysid.rig.planters.bench_state import POINTS, BenchState, steady_bench
from sysid.rig.planters.planter import Planter, plant_all
from sysid.rig.planters.valve import BoucWenValve, HystereticValve, Valve
from sysid.rig.trial_design import (
    DAMPER,
    DESIGN,
    MISFIT,
    STANDARD,
    TrialDesign,
    random_numbers,
)
from sysid.rig.trial_matrix import settings_below
from sysid.rig.trial_misfit import law_factors
from sysid.rig.trial_recording import binned, record
from sysid.rig.trial_size import planted_size, scaled_to

Grid = Float[np.ndarray, "loop phase"]
PerLoop = Float[np.ndarray, " loop"]

_COLDEST, _HOTTEST = 12.0, 70.0
_ASKED = ("amplitude", "frequency", "current")


@dataclass(frozen=True)
class TrialTruth:
    """What is true of a campaign; nothing of it shows when it is printed.

    Attributes:
        planters: With the sizes that were planted.
        causes: Ids of the catalogue's effects that were planted, all of them.
        families: Of each planter, as declared; None where it belongs to none.
        sizes: Of each planter alone, % of the RMS force without any.
        nominal: Of each planter, quantity → value, SI.
        parameters: Of the damper, symbol → value.
        misfit: ε.
        force: [L, J] N, with the effects, without errors of the rig.
        force_without: [L, J] N, of the damper alone.
        gain: [L] relative error of the load cell.
        offset: [L] N.
        delay: [L] s.
    """

    planters: tuple[Planter, ...] = field(repr=False)
    causes: tuple[str, ...] = field(repr=False)
    families: tuple[str | None, ...] = field(repr=False)
    sizes: tuple[float, ...] = field(repr=False)
    nominal: tuple[dict[str, float], ...] = field(repr=False)
    parameters: dict[str, float] = field(repr=False)
    misfit: float = field(repr=False)
    force: Grid = field(repr=False)
    force_without: Grid = field(repr=False)
    gain: PerLoop = field(repr=False)
    offset: PerLoop = field(repr=False)
    delay: PerLoop = field(repr=False)


@dataclass(frozen=True)
class Trial:
    """One trial campaign.

    Attributes:
        loops: As a diagnosis gets them.
        run_order: [L] position of each test in the campaign, from 1.
        truth: Sealed until the diagnosis has answered.
        seed: Of all random numbers.
        design: How it was run.
        visits: Tests that were asked for, each time that the damper came into the rig.
    """

    loops: Loops
    run_order: Int[np.ndarray, " loop"]
    truth: TrialTruth
    seed: int
    design: TrialDesign
    visits: tuple[tuple[Setting, ...], ...]

    @property
    def history(self) -> RunHistory:
        """What was run before each test."""
        return run_history(self.run_order, self.loops.current)


def make_trial(
    seed: int,
    planters: tuple[Planter, ...] = (),
    percents: tuple[float, ...] | None = None,
    design: TrialDesign = STANDARD,
    settings: tuple[Setting, ...] | None = None,
) -> Trial:
    """Run a trial campaign.

    Args:
        seed: Names all random numbers; the same seed with other planters, sizes or misfit has
            the same tests, damper, errors and noise.
        planters: What is hidden.
        percents: Size of each, % of the RMS force without any; None plants them as they are.
        design: How the campaign is run.
        settings: Its tests; a random choice of W11's below the design's speed if None.

    Raises:
        DataError: The sizes do not belong to the planters or cannot be reached, or the number of
            points does not divide the fine grid.
    """
    if POINTS % design.points:
        raise DataError(f"a loop of {design.points} points is no part of one of {POINTS}")
    if percents is not None and len(percents) != len(planters):
        raise DataError(f"{len(percents)} sizes were given for {len(planters)} planters")
    if settings is None:
        settings = _choose_tests(design, seed)
    state, parameters = _bench(design, seed, (settings,))
    if percents is not None:
        planters = tuple(
            scaled_to(planter, state, percent)
            for planter, percent in zip(planters, percents, strict=True)
        )
    planted = plant_all(planters, state)
    loops, errors = record(design, settings, planted, seed)
    truth = TrialTruth(
        planters=planters,
        causes=tuple(cause for planter in planters for cause in planter.causes),
        families=tuple(planter.family for planter in planters),
        sizes=tuple(planted_size(planter, state) for planter in planters),
        nominal=tuple(planter.nominal() for planter in planters),
        parameters=parameters,
        misfit=design.misfit,
        force=binned(planted.force, design.points),
        force_without=binned(state.force, design.points),
        gain=errors[0],
        offset=errors[1],
        delay=errors[2],
    )
    return Trial(loops, state.run_order, truth, seed, design, (settings,))


def with_tests(trial: Trial, settings: tuple[Setting, ...]) -> Trial:
    """The same damper back in the rig: a campaign and further tests after it.

    Args:
        trial: The campaign so far, which stays as it was measured.
        settings: Further tests.

    Raises:
        DataError: The planted effects cannot act in such tests.
    """
    design, seed, visit = trial.design, trial.seed, len(trial.visits)
    visits = (*trial.visits, settings)
    # all tests together: a chamber, say, has the volume that it had in the first visit
    every, _ = _bench(design, seed, visits)
    count = len(settings)
    state, planted = (_last(one, count) for one in (every, plant_all(trial.truth.planters, every)))
    loops, errors = record(design, settings, planted, seed, visit)
    loops = replace(loops, ids=tuple(f"{name}_visit{visit}" for name in loops.ids))
    before = trial.truth
    truth = replace(
        before,
        force=np.concatenate([before.force, binned(planted.force, design.points)]),
        force_without=np.concatenate([before.force_without, binned(state.force, design.points)]),
        gain=np.concatenate([before.gain, errors[0]]),
        offset=np.concatenate([before.offset, errors[1]]),
        delay=np.concatenate([before.delay, errors[2]]),
    )
    return Trial(trial.loops.joined(loops), every.run_order, truth, seed, design, visits)


def _last(state: BenchState, count: int) -> BenchState:
    """The last tests of some."""
    arrays = {f.name: getattr(state, f.name) for f in fields(state)}
    return replace(state, **{k: z[-count:] for k, z in arrays.items() if isinstance(z, np.ndarray)})


def _choose_tests(design: TrialDesign, seed: int) -> tuple[Setting, ...]:
    """A random choice, in the order of the matrix."""
    every = settings_below(design.peak_velocity)
    random = random_numbers(seed, DESIGN)
    count = int(random.integers(design.fewest, design.most + 1))
    chosen = np.sort(random.permutation(len(every))[: min(count, len(every))])
    return tuple(every[k] for k in chosen)


def _bench(
    design: TrialDesign, seed: int, visits: tuple[tuple[Setting, ...], ...]
) -> tuple[BenchState, dict[str, float]]:
    """The tests without hidden effects, and the damper's parameters."""
    random = random_numbers(seed, DAMPER)
    symbols = sorted(LOW_SYMMETRIC)
    spread = np.exp(design.parameter_spread * random.normal(size=len(symbols)))
    parameters = {s: LOW_SYMMETRIC[s] * float(x) for s, x in zip(symbols, spread, strict=True)}
    parameters["k_1e"] = parameters["k_1c"]
    tests = [setting for settings in visits for setting in settings]
    a, f, i = (np.array([getattr(t, name) for t in tests]) for name in _ASKED)
    of_a, of_f, warm, order = _reached(design, seed, visits, random)
    true_a, true_f = a * of_a, f * of_f
    valve: Valve
    if design.model == "bouc_wen":
        valve = _bouc_wen(1.0 / (POINTS * true_f[:, None]), spread)
        parameters = {
            "x_y": valve.yield_travel,
            "c_0": valve.viscosity[0],
            "c_1": valve.viscosity[1],
            "alpha_0": valve.strength[0],
            "alpha_1": valve.strength[1],
            "i_s": valve.saturation,
        }
    else:
        draw = int(random_numbers(seed, MISFIT).integers(2**31))
        valve = HystereticValve(parameters, law_factors(design.misfit, a, f, i, draw))
    state = steady_bench(
        valve,
        true_a,
        true_f,
        i,
        temperature=np.clip(warm, _COLDEST, _HOTTEST),
        run_order=order,
        cycles=design.cycles,
        triangular=np.array([t.triangular for t in tests]),
        built_for=len(visits[0]),
        stroke=design.stroke,
    )
    return state, parameters


def _reached(
    design: TrialDesign,
    seed: int,
    visits: tuple[tuple[Setting, ...], ...],
    random: np.random.Generator,
) -> tuple[PerLoop, ...]:
    """Amplitude and frequency over what was asked for, temperature in °C, place in the order.

    The first visit draws from `random`, later ones from streams of their own.
    """
    drawn, done = [], 0
    for visit, settings in enumerate(visits):
        if visit:
            random = random_numbers(seed, DAMPER, visit)
        count = len(settings)
        drawn.append((
            1.0 + design.amplitude_sd * random.normal(size=count),
            1.0 + design.frequency_sd * random.normal(size=count),
            design.temperature + design.temperature_sd * random.normal(size=count),
            done + random.permutation(count) + 1,
        ))  # fmt: skip
        done += count
    return tuple(np.concatenate(z) for z in zip(*drawn, strict=True))


def _bouc_wen(
    time_step: Float[np.ndarray, "loop 1"], spread: Float[np.ndarray, " draw"]
) -> BoucWenValve:
    """A Bouc-Wen damper near the usual one."""
    usual = BoucWenValve(time_step)
    factors = spread.tolist()
    return BoucWenValve(
        time_step,
        yield_travel=usual.yield_travel * factors[0],
        viscosity=(usual.viscosity[0] * factors[1], usual.viscosity[1] * factors[2]),
        strength=(usual.strength[0] * factors[3], usual.strength[1] * factors[4]),
        saturation=usual.saturation * factors[5],
    )
