"""What the rig records of trial tests: loops with the errors of a good test rig.

The physics is solved on a fine phase grid; a recorded point is the mean over its phase bin, as it
is in loops that are cut from records: a rig that took points of it without averaging would hit or
miss what is shorter than a point, a play of 20 µm say.
"""

import numpy as np
from jaxtyping import Float

from sysid.data.harmonics import ORDER
from sysid.data.loops import Loops
from sysid.rig.bench import Setting
from sysid.rig.planters.bench_state import POINTS, BenchState
from sysid.rig.planters.periodic import shifted
from sysid.rig.trial_design import ERRORS, NOISE, TrialDesign, random_numbers

PerLoop = Float[np.ndarray, " loop"]


def record(
    design: TrialDesign,
    settings: tuple[Setting, ...],
    state: BenchState,
    seed: int,
    *visit: int,
) -> tuple[Loops, tuple[PerLoop, PerLoop, PerLoop]]:
    """What the rig records, and its errors of gain, zero (N) and delay (s), each [L].

    Args:
        design: How the campaign is run.
        settings: Of L tests, as asked for.
        state: They, with whatever is hidden in them.
        seed: Of the campaign.
        visit: Number of a later visit to the rig; the first has none.
    """
    random = random_numbers(seed, ERRORS, *visit)
    count, stride = len(settings), POINTS // design.points
    gain, offset, delay = (
        sd * random.normal(size=count) for sd in (design.gain_sd, design.offset_sd, design.delay_sd)
    )
    centre = 3.2e-3 + 2e-4 * random.normal(size=count)
    late = binned(shifted(state.force, delay / state.time_step), design.points)
    mean = (1.0 + gain)[:, None] * late + offset[:, None]
    rms = np.sqrt(np.mean(late**2, axis=1))
    sigma = np.maximum(design.noise, design.relative_noise * rms)
    noise = random_numbers(seed, NOISE, *visit)
    shape = (count, design.cycles, design.points)
    cycles = sigma[:, None, None] * noise.normal(size=shape)
    if state.departures is not None:
        cycles = cycles + binned(state.departures, design.points)
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


def binned(fine: Float[np.ndarray, "... fine"], points: int) -> Float[np.ndarray, "... point"]:
    """Means over phase bins, whose edges halve a step of the fine grid where its number is even.

    Args:
        fine: Of any unit, on the fine phase grid.
        points: Of a loop; a divisor of the grid's.
    """
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
