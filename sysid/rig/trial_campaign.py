"""Trial campaigns: loops of a damper with hidden effects, and the truth about them.

A campaign is a random choice of W11's tests, run on a damper near W11's low-range set, with the
errors of a good test rig.  The physics is solved on a fine phase grid; a recorded point is the mean
over its phase bin, as it is in loops that are cut from records: a rig that took points of it
without averaging would hit or miss what is shorter than a point, a play of 20 µm say.
"""

from dataclasses import dataclass, field, fields, replace
from typing import Final, Literal

import numpy as np
from jaxtyping import Float, Int

from sysid.data.harmonics import ORDER
from sysid.data.loops import Loops
from sysid.errors import DataError
from sysid.models.generalized import LOW_SYMMETRIC
from sysid.motion.history import RunHistory, run_history
from sysid.rig.bench import Setting
from sysid.rig.planters.bench_state import POINTS, BenchState, steady_bench
from sysid.rig.planters.periodic import shifted
from sysid.rig.planters.planter import Planter, plant_all
from sysid.rig.planters.valve import BoucWenValve, HystereticValve, Valve
from sysid.rig.trial_matrix import settings_below
from sysid.rig.trial_misfit import law_factors
from sysid.rig.trial_size import planted_size, scaled_to

Grid = Float[np.ndarray, "loop phase"]
PerLoop = Float[np.ndarray, " loop"]

_DESIGN, _DAMPER, _MISFIT, _ERRORS, _NOISE = range(5)
"""Streams of random numbers of one campaign."""

_COLDEST, _HOTTEST = 12.0, 70.0
_ASKED = ("amplitude", "frequency", "current")


@dataclass(frozen=True)
class TrialDesign:
    """How a trial campaign is run.

    Attributes:
        fewest: Tests.
        most: Tests.
        points: Of a recorded loop; a divisor of the fine grid's 720.
        cycles: Steady cycles of a test.
        peak_velocity: Highest Aω, m/s.
        model: Law of the damper, "w11" or "bouc_wen".
        parameter_spread: Standard deviation of ln(parameter / published value).
        misfit: ε of `law_factors`; the share of force that a refit leaves follows from it.
        noise: Standard deviation per point and cycle, N; 9 N on 360 points are 4 N on 72.
        relative_noise: The same as a share of the test's RMS force; the larger one counts.
        gain_sd: Relative error of the load cell's gain, over tests.
        offset_sd: Of its zero, N.
        delay_sd: Of the force channel, s.
        amplitude_sd: Relative error of the stroke reached.
        frequency_sd: Relative error of the frequency.
        temperature: °C.
        temperature_sd: Over tests, K.
        displacement_noise: Per point and cycle, m.
        stroke: m, amplitude that damper and rig were built for; the widest of the first tests if
            None.
    """

    fewest: int = 60
    most: int = 110
    points: int = 360
    cycles: int = 8
    peak_velocity: float = 0.4
    model: Literal["w11", "bouc_wen"] = "w11"
    parameter_spread: float = 0.05
    misfit: float = 0.0
    noise: float = 9.0
    relative_noise: float = 0.0
    gain_sd: float = 6e-3
    offset_sd: float = 2.0
    delay_sd: float = 1e-4
    amplitude_sd: float = 4e-3
    frequency_sd: float = 5e-4
    temperature: float = 40.0
    temperature_sd: float = 10.0
    displacement_noise: float = 3e-6
    stroke: float | None = None


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


STANDARD: Final = TrialDesign()


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
    loops, errors = _record(design, settings, planted, seed)
    truth = TrialTruth(
        planters=planters,
        causes=tuple(cause for planter in planters for cause in planter.causes),
        families=tuple(planter.family for planter in planters),
        sizes=tuple(planted_size(planter, state) for planter in planters),
        nominal=tuple(planter.nominal() for planter in planters),
        parameters=parameters,
        misfit=design.misfit,
        force=_binned(planted.force, design.points),
        force_without=_binned(state.force, design.points),
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
    loops, errors = _record(design, settings, planted, seed, visit)
    loops = replace(loops, ids=tuple(f"{name}_visit{visit}" for name in loops.ids))
    before = trial.truth
    truth = replace(
        before,
        force=np.concatenate([before.force, _binned(planted.force, design.points)]),
        force_without=np.concatenate([before.force_without, _binned(state.force, design.points)]),
        gain=np.concatenate([before.gain, errors[0]]),
        offset=np.concatenate([before.offset, errors[1]]),
        delay=np.concatenate([before.delay, errors[2]]),
    )
    return Trial(trial.loops.joined(loops), every.run_order, truth, seed, design, visits)


def _last(state: BenchState, count: int) -> BenchState:
    """The last tests of some."""
    arrays = {f.name: getattr(state, f.name) for f in fields(state)}
    return replace(state, **{k: z[-count:] for k, z in arrays.items() if isinstance(z, np.ndarray)})


def _random(seed: int, stream: int, *visit: int) -> np.random.Generator:
    return np.random.default_rng([seed, stream, *visit])


def _choose_tests(design: TrialDesign, seed: int) -> tuple[Setting, ...]:
    """A random choice, in the order of the matrix."""
    every = settings_below(design.peak_velocity)
    random = _random(seed, _DESIGN)
    count = int(random.integers(design.fewest, design.most + 1))
    chosen = np.sort(random.permutation(len(every))[: min(count, len(every))])
    return tuple(every[k] for k in chosen)


def _bench(
    design: TrialDesign, seed: int, visits: tuple[tuple[Setting, ...], ...]
) -> tuple[BenchState, dict[str, float]]:
    """The tests without hidden effects, and the damper's parameters."""
    random = _random(seed, _DAMPER)
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
        draw = int(_random(seed, _MISFIT).integers(2**31))
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
            random = _random(seed, _DAMPER, visit)
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


def _record(
    design: TrialDesign,
    settings: tuple[Setting, ...],
    state: BenchState,
    seed: int,
    *visit: int,
) -> tuple[Loops, tuple[PerLoop, PerLoop, PerLoop]]:
    """What the rig records, and its errors of gain, zero (N) and delay (s)."""
    random = _random(seed, _ERRORS, *visit)
    count, stride = len(settings), POINTS // design.points
    gain, offset, delay = (
        sd * random.normal(size=count) for sd in (design.gain_sd, design.offset_sd, design.delay_sd)
    )
    centre = 3.2e-3 + 2e-4 * random.normal(size=count)
    late = _binned(shifted(state.force, delay / state.time_step), design.points)
    mean = (1.0 + gain)[:, None] * late + offset[:, None]
    rms = np.sqrt(np.mean(late**2, axis=1))
    sigma = np.maximum(design.noise, design.relative_noise * rms)
    noise = _random(seed, _NOISE, *visit)
    shape = (count, design.cycles, design.points)
    cycles = sigma[:, None, None] * noise.normal(size=shape)
    if state.departures is not None:
        cycles = cycles + _binned(state.departures, design.points)
    scatter = cycles.mean(axis=1)
    deviations = cycles - scatter[:, None, :]
    paths = design.displacement_noise * noise.normal(size=shape)
    floor = np.full(count, np.nan)
    if design.cycles > 1:
        floor = np.sqrt(np.mean(np.var(cycles, axis=1, ddof=1), axis=1))
    harmonics = np.zeros((count, ORDER), dtype=np.complex128)
    harmonics[:, 0] = state.amplitude
    if state.triangular is not None and state.triangular.any():
        turned = np.fft.rfft(state.displacement[state.triangular], axis=1)[:, 1 : ORDER + 1]
        harmonics[state.triangular] = 2.0j / POINTS * turned
    loops = Loops(
        ids=tuple(_name(setting) for setting in settings),
        displacement=state.displacement[:, ::stride].copy(),
        velocity=state.velocity[:, ::stride].copy(),
        acceleration=state.acceleration[:, ::stride].copy(),
        force=mean + scatter,
        amplitude=state.amplitude,
        frequency=state.frequency,
        current=state.current,
        temperature=state.temperature,
        centre=centre,
        cycles=np.full(count, design.cycles, dtype=np.int64),
        noise_floor=floor,
        deviations=tuple(deviations),
        displacement_deviations=tuple(paths - paths.mean(axis=1)[:, None, :]),
        harmonics=harmonics,
        start_phase=np.zeros(count),
    )
    return loops, (gain, offset, delay)


def _binned(fine: Float[np.ndarray, "... fine"], points: int) -> Float[np.ndarray, "... point"]:
    """Means over phase bins, whose edges halve a step of the fine grid where its number is even."""
    stride = fine.shape[-1] // points
    if stride == 1:
        return fine.copy()
    half = stride // 2
    weights = np.ones(2 * half + 1) / stride
    if stride % 2 == 0:
        weights[[0, -1]] /= 2.0
    shifts = range(-half, half + 1)
    total = sum(w * np.roll(fine, -k, axis=-1) for w, k in zip(weights, shifts, strict=True))
    return np.asarray(total)[..., ::stride]


def _name(setting: Setting) -> str:
    wave = "_triangle" if setting.triangular else ""
    return f"{1e3 * setting.amplitude:g}mm_{setting.frequency:g}Hz_{setting.current:g}A{wave}"
